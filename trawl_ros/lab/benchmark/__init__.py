# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The benchmark: speed, compared with other codes."""
