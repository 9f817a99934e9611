"""Validation, benchmark and demo of the package; only `testing/` imports them."""
