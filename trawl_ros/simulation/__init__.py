"""Simulation of a tow in time: ship, winches, sea and gear; its output is the truth."""
