"""Swell by the swing of the tension: told in a sea, and not of winches or noise."""

import numpy as np
import pytest

from trawl_ros.estimation.motion.series import Series, TowReadings, series_of
from trawl_ros.estimation.motion.swell import swell_of
from trawl_ros.records.channels import CHANNELS

MEAN, NOISE = 1.6e5, 1.6e3
NOTHING = Series(np.zeros(0), np.zeros(0))


def read(swing, *, every=0.5, haul=0.0):
    """Half an hour of both warps; port swings by a part of the mean (std) with a period of 10 s."""
    rng, times = np.random.default_rng(7), np.arange(0.0, 1800.0, every)
    wave = np.sqrt(2.0) * swing * np.sin(2.0 * np.pi * times / 10.0)
    ramp = haul * np.clip((times - 600.0) / 5.0, 0.0, 1.0)
    own = MEAN * (1.0 + wave + ramp) + NOISE * rng.standard_normal(len(times))
    other = MEAN + NOISE * rng.standard_normal(len(times))
    series = {
        name: series_of(CHANNELS[name], times, values, NOISE)
        for name, values in (('port_tension', own), ('starboard_tension', other))
    }
    return TowReadings(0, series, (NOTHING, NOTHING))


@pytest.mark.parametrize('swing', [0.02, 0.05])
def test_a_swell_is_told_by_its_swing(swing):
    assert swell_of(read(swing), 30.0) == pytest.approx(swing, rel=0.1)


@pytest.mark.parametrize(
    'tow',
    [
        read(0.0),
        read(0.0, haul=0.3),
        read(0.05, every=5.0),
        TowReadings(0, {}, (NOTHING, NOTHING)),
    ],
    ids=['calm sea', 'a winch starts', 'read now and then', 'no tension'],
)
def test_of_what_is_no_swell_nothing_is_told(tow):
    assert swell_of(tow, 30.0) == 0.0
