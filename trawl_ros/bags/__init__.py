# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Writing, reading, checking, repair and export of bags of messages."""
