"""Base class of effects."""
