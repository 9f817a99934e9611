"""Multifrontal factorisation of the gear's sparse matrices, and the budget of a search."""
