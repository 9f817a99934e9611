# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Common parts of reports: templates, pictures, and the style of figures."""
