# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags on the graph: which topics, which stretch, with which quality of service."""
