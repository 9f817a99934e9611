# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reading and writing of sentences of ships' instruments, by a table in YAML."""
