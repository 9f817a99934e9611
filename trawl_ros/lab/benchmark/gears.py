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
    warp = gear.warp.model_copy(update={'segments': 6})
    return with_around(gear.model_copy(update={'warp': warp}), 12)


def with_around(gear: GearRecord, around: int) -> GearRecord:
    """Return the gear with ``around`` meshes around its net, and rows of the matching length."""
    netting = gear.netting.model_copy(update={'around': around})
    return gear.model_copy(update={'netting': netting})
