"""Dense fronts of a sparse matrix: numerical factorisation and solutions, compiled."""
