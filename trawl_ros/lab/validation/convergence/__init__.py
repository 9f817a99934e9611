# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Convergence of the solution with time step and mesh."""
