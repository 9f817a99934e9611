# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What commands share at the terminal: progress, interruption, tables and lazy loading."""
