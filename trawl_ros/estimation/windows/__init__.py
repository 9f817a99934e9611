"""Steady windows: stamps, buffers and means of channels, and what is refused."""
