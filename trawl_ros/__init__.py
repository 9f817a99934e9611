"""Emulates the instruments of a mid-water trawler and keeps the model of its gear honest."""

__version__ = '0.1.0'
