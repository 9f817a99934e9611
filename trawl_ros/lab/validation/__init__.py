# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of the model's claims: closed forms, convergence, the paper, peers, branches."""
