"""Estimation and diagnosis in threads beside a node, and their statuses."""
