"""Convergence of the solution with time step and mesh."""
