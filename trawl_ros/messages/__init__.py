# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion between records and ROS messages, and encoding of messages as CDR bytes."""
