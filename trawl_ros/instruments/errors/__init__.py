# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Errors, faults and timing that all instruments share."""
