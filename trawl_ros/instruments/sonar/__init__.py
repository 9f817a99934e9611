# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The trawl sonar: echoes in its beams, its image, and readings from it."""
