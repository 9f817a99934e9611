"""The default gear, whole and cut coarsely, and a gear of two bare warps."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.line import BarProperties
from trawl_ros.model.pattern import build_pattern
from trawl_ros.model.water import Water


@pytest.fixture(scope='session')
def gear() -> GearRecord:
    return load_gear('kaifuha')


@pytest.fixture(scope='session')
def default_model(gear: GearRecord) -> GearModel:
    return build_model(gear)


@pytest.fixture(scope='session')
def model(gear: GearRecord) -> GearModel:
    """The gear with its netting as coarse as it may be, which is quicker and no less general."""
    return build_model(
        gear.model_copy(update={'netting': gear.netting.model_copy(update={'around': 12})})
    )


@pytest.fixture(scope='session')
def bare_model(gear: GearRecord) -> Callable[..., GearModel]:
    """Build a gear model of nothing but two warps of one make, cut into ``segments``.

    Their ends are free nodes; the boards float without ropes, area, weight or water.
    """

    def build(warp: dict[str, float], segments: int, water: Water) -> GearModel:
        record = gear.model_copy(
            update={'warp': gear.warp.model_copy(update={**warp, 'segments': segments})}
        )
        whole = build_model(record)
        count, bars = 2 * segments, 2 * segments
        blocks = count + 6 + np.arange(2)
        ends = np.array(
            [
                [blocks[side] if k == 0 else side * segments + k - 1, side * segments + k]
                for side in range(2)
                for k in range(segments)
            ]
        )
        nothing = np.zeros(count)
        return replace(
            whole,
            water=water,
            board=replace(
                whole.board,
                mass=0.0,
                volume=0.0,
                area=0.0,
                rotary_slope=0.0,
                inertia=np.zeros((3, 3)),
            ),
            kite=replace(whole.kite, area=0.0, mass=0.0, volume=0.0),
            bars=BarProperties(*(values[:1].repeat(bars) for values in vars(whole.bars).values())),
            ends=ends,
            rest=np.ones(bars),
            warp_side=np.arange(2).repeat(segments),
            lump_mass=nothing,
            lump_volume=nothing,
            lump_drag_area=nothing,
            lump_added=nothing,
            layout=replace(whole.layout, kite=(0, 1), top_warp_bars=np.array([0, segments])),
            pattern=build_pattern(count, ends, (0, 1)),
        )

    return build
