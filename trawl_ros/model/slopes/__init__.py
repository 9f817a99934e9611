# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of forces and inertia by more than positions and velocities."""
