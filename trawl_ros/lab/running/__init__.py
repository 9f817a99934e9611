"""Nodes as processes, and monitors of a running graph."""
