"""Empirical terms for what no effect of the catalogue explains."""
