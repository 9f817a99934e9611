# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Methods that answer blind trials: the diagnosis of the project, and baselines."""
