# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The net as nodes and bars: rows of meshes, the mouth, and its netting."""
