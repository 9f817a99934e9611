"""Studies: long runs of the whole chain, and their reports."""
