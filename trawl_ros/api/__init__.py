# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Use cases of the package as functions; commands and nodes are thin around them.

Files are named as a user names them: a path, or the bare name of what comes with the package.
"""
