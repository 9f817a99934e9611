"""Validation, benchmark, studies and demo: run once in a while, imported by nothing else."""
