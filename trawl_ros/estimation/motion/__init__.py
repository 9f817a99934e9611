# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Estimation from a whole tow: stretches in motion, towed with derivatives."""
