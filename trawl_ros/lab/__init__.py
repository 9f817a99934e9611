# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Validation, benchmark and demo of the package; only `testing/` imports them."""
