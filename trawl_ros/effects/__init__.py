# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Physics and errors of instruments beyond the paper: registry, and the set of a gear file."""
