# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Onset of effects while a tow goes on: likelihood ratios of whitened innovations."""
