# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison of a log with a gear file as it is, or of two bags; nothing is fitted."""
