# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Instruments of a trawler: truth in, samples with errors out; no ROS."""
