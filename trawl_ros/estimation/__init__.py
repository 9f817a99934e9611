"""From samples or bags to an estimate of the coefficients."""
