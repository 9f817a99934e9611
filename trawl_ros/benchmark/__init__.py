"""Benchmark against other tools: the modules of `trawl benchmark`."""
