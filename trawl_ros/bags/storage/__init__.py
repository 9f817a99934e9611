# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Files of bags: MCAP and SQLite, also damaged ones, with their metadata."""
