# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tow in motion: its record, its inputs with their errors, and the model towed along it."""
