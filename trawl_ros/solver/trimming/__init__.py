# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim over a range of speeds and warps, and from what was measured."""
