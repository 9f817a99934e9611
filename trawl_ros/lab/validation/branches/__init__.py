# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Existence of steady states, and the reasons for refusals."""
