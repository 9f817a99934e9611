"""Hostile messages to every subscription of every node."""
