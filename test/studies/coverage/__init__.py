"""Intervals and predictions of identification, from trials whose plant is not the model."""
