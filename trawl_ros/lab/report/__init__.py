# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records and pages shared by validation, benchmark and studies."""
