# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Multifrontal factorisation of the gear's sparse matrices, and the budget of a search."""
