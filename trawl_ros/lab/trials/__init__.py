"""Blind cases: effects hidden in a plant that differs from the model, and scores of verdicts."""
