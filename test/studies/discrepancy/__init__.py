"""Blind trials of the diagnosis: planned, diagnosed, scored."""
