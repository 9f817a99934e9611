"""Robustness of the model: changed gears, and hours of random commands."""
