"""Figures of a tow from a bag."""
