# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records that flow between rooms: truth, samples, channels, the table of topics."""
