"""Bounded least squares in information form; it knows nothing of trawls."""
