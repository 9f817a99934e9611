# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The report of an identification: JSON, tables, figures, page."""
