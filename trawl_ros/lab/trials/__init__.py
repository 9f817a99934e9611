# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Blind cases: effects hidden in a plant that differs from the model, and scores of verdicts."""
