"""The benchmark: speed, beside other tools."""
