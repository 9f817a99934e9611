"""The benchmark: speed, compared with other codes."""
