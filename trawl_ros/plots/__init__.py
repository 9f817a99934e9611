# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of the tow in a bag."""
