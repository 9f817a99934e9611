# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Inference of a diagnosis: evidence of hypotheses, posterior, and decision."""
