"""Hostile input for every reader of foreign files: generators, registry, campaigns.

`python -m hostile` (see `make fuzz`) runs all of it; `test_hostile_input.py` a seeded minute.
"""
