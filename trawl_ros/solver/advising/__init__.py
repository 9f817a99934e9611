# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Advice on refused tows, and the changes of a rigging that it may propose."""
