"""Bags on the graph: which topics, which stretch, with which quality of service."""
