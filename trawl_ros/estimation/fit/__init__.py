# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The fit: predictions, errors of readings, Gauss–Newton, the posterior."""
