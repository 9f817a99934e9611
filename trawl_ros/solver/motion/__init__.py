# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Motion in time with its derivatives by parameters, step by step."""
