# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects hidden in blind cases, inside and outside the catalogue."""
