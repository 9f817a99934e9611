"""Other programs on the same wire."""
