"""Effects that are hidden in blind trials, in the catalogue and outside of it."""
