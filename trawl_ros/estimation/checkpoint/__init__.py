# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checkpoint of a running identification."""
