"""Time: integer nanoseconds throughout."""

SECOND = 1_000_000_000
"""Nanoseconds in a second."""
