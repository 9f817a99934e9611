# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The report of a diagnosis: JSON, sentences, figures, page."""
