"""Bases of effects and empirical terms."""
