# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Controllers of winches and rudder: samples in, commands out; no ROS."""
