"""The model is towed through falls of boards, and nothing is compared until all has settled."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import candidate_table
from trawl_ros.diagnosis.onset.stretches import StretchCutter
from trawl_ros.diagnosis.onset.towing import ModelTow, TowedStretch, WatchedGear
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.towing.towed_stretch import BY_SENSOR
from trawl_ros.estimation.motion.towing.under_way import AFTER_A_FALL
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


def test_through_a_fall_the_model_is_towed_on_and_compared_once_all_has_settled(
    cut, towed, with_fall
):
    stretches = cut(14)
    fell, usual = towed(with_fall(stretches, 12)), towed(stretches)
    assert fell[12:23] == [BY_SENSOR] + [AFTER_A_FALL] * 10
    assert len(fell) > 23
    for there, right in zip(fell[23:], usual[23:], strict=True):
        assert isinstance(there, TowedStretch)
        np.testing.assert_allclose(there.values, right.values, rtol=1e-6)
        away = np.linalg.norm(there.by_coefficients - right.by_coefficients)
        assert away < 0.05 * np.linalg.norm(right.by_coefficients)
    begun = [isinstance(one, TowedStretch) for one in usual].index(True)
    # No model is begun in minutes in which a board fell.
    early = towed(with_fall(stretches[: begun + 6], begun - 6))
    assert early[begun:-1] == [AFTER_A_FALL] * 5
    assert isinstance(early[-1], TowedStretch)


def test_a_board_that_lies_through_all_that_is_looked_at_has_fallen_still(cut):
    *_, last = cut(12, 370.0)
    assert last.tow.fallen == tuple(range(len(last.tow)))
