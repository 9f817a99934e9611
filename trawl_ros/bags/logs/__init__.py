# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Import of foreign logs as bags: tables, and NMEA 0183."""
