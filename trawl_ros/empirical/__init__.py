"""Terms for what no effect of the catalogue explains: empirical, and called so."""
