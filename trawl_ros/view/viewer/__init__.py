# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rerun itself: its library, its program as a process with its ports, and its page in a browser."""
