# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trials planned for what they tell of the coefficients."""
