# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The known effects by what they act on, each file with its `EFFECTS`."""
