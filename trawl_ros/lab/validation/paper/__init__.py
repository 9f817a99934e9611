# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reproduction of section IV of the founding paper."""
