"""Derivatives of forces and inertia by more than positions and velocities."""
