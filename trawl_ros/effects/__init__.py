"""Physics and errors of instruments beyond the paper: registry, and the set of a gear file."""
