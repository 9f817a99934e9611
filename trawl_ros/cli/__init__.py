# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The command `trawl`, one file per sub-command."""
