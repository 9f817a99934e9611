"""Cases with a closed-form solution."""
