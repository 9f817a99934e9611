"""Long runs of the whole chain, and what they show."""
