# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Names of the board's coefficients."""

COEFFICIENTS = ('a1', 'c1', 'a2', 'c2', 'b3', 'c3', 'a4', 'c4', 'b5', 'c5', 'a6', 'c6')
"""The twelve coefficients of eq. 14 in the order of eq. 36, which is the order in messages."""
