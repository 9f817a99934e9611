# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison with a net that was measured in a flume tank."""
