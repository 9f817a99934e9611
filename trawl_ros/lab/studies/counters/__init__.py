"""The study of counters that err as measured ones did."""
