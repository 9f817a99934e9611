# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bounded least squares in information form; it knows nothing of trawls."""
