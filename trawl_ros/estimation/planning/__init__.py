"""Trials planned for what they tell of the coefficients."""
