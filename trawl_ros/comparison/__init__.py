"""Comparison of a log with a gear file as it is, or of two bags; nothing is fitted."""
