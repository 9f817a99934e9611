# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""From samples or bags to an estimate of the coefficients."""
