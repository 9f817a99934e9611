"""Gears of the benchmark."""

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord


def default_gear(*, small: bool) -> GearRecord:
    """The gear that comes with the package; a coarse one of the same make when ``small``."""
    gear = load_gear('kaifuha')
    if not small:
        return gear
    warp = gear.warp.model_copy(update={'segments': 6})
    return with_around(gear.model_copy(update={'warp': warp}), 12)


def with_around(gear: GearRecord, around: int) -> GearRecord:
    """The gear with its net cut into ``around`` meshes around, and rows as short as they ask."""
    netting = gear.netting.model_copy(update={'around': around})
    return gear.model_copy(update={'netting': netting})
