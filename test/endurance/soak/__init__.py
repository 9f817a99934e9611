"""The chain of nodes for a day at sea."""
