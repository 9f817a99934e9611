"""Linear algebra of the solver: factors of sparse matrices, and eigenvalues of operators."""
