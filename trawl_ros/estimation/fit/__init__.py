"""The fit: predictions, errors of readings, Gauss–Newton, the posterior."""
