"""Simulated range sensors compared with those of a survey."""
