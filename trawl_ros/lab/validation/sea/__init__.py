"""Comparison with published hauls at sea."""
