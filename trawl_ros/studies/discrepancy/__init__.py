"""Blind tests of ``trawl diagnose``: effects hidden in data of another plant."""
