# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Netting panels in a stream: published tests, compared with the model."""
