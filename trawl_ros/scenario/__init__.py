# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A trial as a file: what ship and winches do, with which gear, water and instruments."""
