"""Checkpoint of a running identification."""
