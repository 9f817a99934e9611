# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Benchmark of missing effects: blind trials, answers of any program, baselines, and scores."""
