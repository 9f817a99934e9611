"""Existence of steady states, and the reasons for refusals."""
