"""Onset of effects while a tow goes on: likelihood ratios of whitened innovations."""
