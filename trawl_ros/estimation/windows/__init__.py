# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady windows: stamps, buffers and means of channels, and what is refused."""
