"""Existence of steady states, and the refusals where there is none."""
