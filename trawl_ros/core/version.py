# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Version of the package, in this one place; package.xml is held equal to it by a test."""

__version__ = '0.2.0'
