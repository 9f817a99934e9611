"""Bags of messages: written, read, checked, repaired and exported."""
