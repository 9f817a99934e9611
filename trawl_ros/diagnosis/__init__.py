"""Discrepancies between model and sea: detected, located, named, and repaired in the gear."""
