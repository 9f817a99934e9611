"""The soak: the chain for a day at sea."""
