# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The graph as ROS 2 shows it: discovery, publishers, quality of service, security."""
