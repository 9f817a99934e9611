"""Trials of the estimator on plants that are not its model."""
