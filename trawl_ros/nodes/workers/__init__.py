# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Estimation and diagnosis in threads next to a node, and their statuses."""
