"""Readings of the trawl sonar's image against truth."""
