"""Comparison with reference codes on the same wire."""
