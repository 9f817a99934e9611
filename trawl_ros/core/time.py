# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Time: integer nanoseconds throughout."""

SECOND = 1_000_000_000
"""Nanoseconds in a second."""
