# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The gear file: records checked on load, frozen, with the unit in each key."""
