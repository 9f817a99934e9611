# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Nodes as processes, and monitors of a running graph."""
