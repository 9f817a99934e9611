"""Fits of all of a tow compared with fits of its steady windows."""
