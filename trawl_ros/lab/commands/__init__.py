# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The commands of the lab: `trawl validate`, `trawl benchmark`."""
