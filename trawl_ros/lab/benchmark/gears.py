# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gears of the benchmark."""

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord


def default_gear(*, quick: bool) -> GearRecord:
    """Return the default gear, or a coarse version of it if ``quick``."""
    gear = load_gear('kaifuha')
    if not quick:
        return gear
    return gear.changed('warp', segments=6).changed('netting', around=12)
