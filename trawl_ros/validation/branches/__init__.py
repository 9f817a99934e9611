"""Where steady states exist, and what is said where none does."""
