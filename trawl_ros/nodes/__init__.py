# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""ROS nodes, one file per executable; no physics."""
