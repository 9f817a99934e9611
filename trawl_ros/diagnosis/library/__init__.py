# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Library of hypotheses: effects, changes of the gear file and errors of instruments."""
