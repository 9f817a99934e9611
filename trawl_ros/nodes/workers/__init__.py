"""Estimation and diagnosis in threads next to a node, and their statuses."""
