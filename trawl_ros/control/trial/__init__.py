# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trial that runs itself: its states, limits, transits, and what it keeps through a restart."""
