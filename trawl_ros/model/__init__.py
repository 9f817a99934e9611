# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The paper's equations: water, lines, boards, kite and netting, and their assembly."""
