"""Steady states, their stability and sensitivities, motion in time, and trim."""
