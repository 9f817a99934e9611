# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Cases with a closed-form solution."""
