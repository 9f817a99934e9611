# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady states, their stability and sensitivities, motion in time, and trim."""
