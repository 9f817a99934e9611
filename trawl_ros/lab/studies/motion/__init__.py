"""Tows in motion whose plant is not the model: what a fit of all of each is worth."""
