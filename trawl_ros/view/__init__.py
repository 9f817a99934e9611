# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""View of a tow in Rerun, in space and over time: records, recording and viewer."""
