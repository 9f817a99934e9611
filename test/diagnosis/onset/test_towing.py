"""The model is towed through falls of boards, and nothing is compared until all has settled."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.stretches import StretchCutter
from trawl_ros.diagnosis.onset.towing import AFTER_A_FALL, ModelTow, TowedStretch, WatchedGear
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.towing.lineariser import BY_SENSOR
from trawl_ros.gear.load import load_gear
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import AttitudeSample

LIES = 2.6


@pytest.fixture(scope='module')
def onset_gear(coarse_gear):
    return load_gear(coarse_gear)


@pytest.fixture
def cut(onset_gear, onset_samples):
    def stretches(minutes, lies_from_s=np.inf):
        """Stretches of a tow whose port board lies from a time on."""
        cutter, found = StretchCutter(build_water(onset_gear).depth), []
        for sample in onset_samples(minutes):
            own = isinstance(sample, AttitudeSample) and sample.side == 'port'
            if own and sample.stamp >= lies_from_s * SECOND:
                sample = replace(sample, roll=LIES)
            found += cutter.feed(sample)
        return found

    return stretches


@pytest.fixture
def towed(onset_gear):
    table = candidate_table({'net_drag': catalogue()['net_drag']})
    gear = WatchedGear(build_model(onset_gear), effects_of(onset_gear), table.at_one_hour())
    values = onset_gear.board.coefficients.array()
    return lambda stretches: list(map(ModelTow(gear, values).advance, stretches))


def test_after_a_fall_the_model_begins_again_once_no_minute_before_has_one(cut, towed, with_fall):
    stretches = cut(14)
    fell, usual = towed(with_fall(stretches, 12)), towed(stretches)
    assert isinstance(usual[12], TowedStretch)
    assert fell[12] == BY_SENSOR
    assert AFTER_A_FALL in fell[13:23]
    assert not any(isinstance(one, TowedStretch) for one in fell[12:23])
    assert isinstance(fell[-1], TowedStretch)
    for there, right in zip(fell[-2:], usual[-2:], strict=True):
        np.testing.assert_allclose(there.values, right.values, rtol=0.05, atol=0.05)


def test_a_board_that_lies_through_all_that_is_looked_at_has_fallen_still(cut):
    *_, last = cut(12, 370.0)
    assert last.tow.fallen == tuple(range(len(last.tow)))
