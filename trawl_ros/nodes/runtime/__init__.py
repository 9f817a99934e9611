# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Common ground of all nodes: parameters, quality of service, clocks, credit, a clean end."""
