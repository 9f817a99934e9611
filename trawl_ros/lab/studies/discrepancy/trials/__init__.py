"""Blind trials: planned, made from a plant, and recorded."""
