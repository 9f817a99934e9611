"""Validation, benchmark and demo of the package; no other part imports them."""
