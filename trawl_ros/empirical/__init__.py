"""Empirical terms for residuals that no effect of the catalogue explains."""
