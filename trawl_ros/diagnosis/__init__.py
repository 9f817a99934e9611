# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Discrepancies between model and sea: detected, located, named, and repaired in the gear."""
