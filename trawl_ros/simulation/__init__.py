# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Simulation of a tow in time: ship, winches, sea and gear; its output is the truth."""
