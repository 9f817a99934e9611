"""Netting panels in a stream: published tests, compared with the model."""
