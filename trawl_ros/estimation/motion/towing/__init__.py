"""Tow in motion: its record, its inputs with their errors, and the model towed along it."""
