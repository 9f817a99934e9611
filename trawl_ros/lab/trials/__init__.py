"""Blind trials: effects hidden in a plant that is not the model, and scores of verdicts on them."""
