# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Foundations: errors, limits, checked files, packaged resources, time, parallel tasks."""
