# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bench of autotrawls: the same scenarios with the project's controllers and with another one."""
