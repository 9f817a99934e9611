"""Trim over a range of speeds and warps, and from what was measured."""
