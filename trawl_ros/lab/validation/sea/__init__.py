# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison with published hauls at sea."""
