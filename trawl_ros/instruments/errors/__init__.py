"""Errors, faults and timing that all instruments share."""
