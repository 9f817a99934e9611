"""Calibration errors of a trial's sensors: each channel is wrong as it was drawn, and no other."""

import numpy as np
import pytest

from studies.motion.plant import miscalibrated
from trawl_ros.model.water import build_water
from trawl_ros.records.channels import MEASURED, readings
from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)

SAMPLES = (
    WinchSample(0, (400.0, 401.0), (0.0, 0.0), (150e3, 151e3)),
    PressureSample(0, 'port', 1.2e6, 2e3),
    PressureSample(0, 'sonar', 0.9e6, 2e3),
    AttitudeSample(0, 'starboard', 0.05, -0.3, 0.01),
    RangeSample(0, 'spread', 110.0, 0.4, 1.0, 400.0),
    VelocitySample(0, 'water', np.array([2.2, 0.1, 0.0]), 0.001),
)
UNTOUCHED = (
    RangeSample(0, 'opening_width', 40.0, 0.1, 1.0, 200.0),
    VelocitySample(0, 'ground', np.array([2.2, 0.1, 0.0]), 0.001),
    HeadingSample(0, 1.0, 0.01),
)
NAMES = (*MEASURED, 'port_length', 'starboard_length', 'speed')


@pytest.fixture(scope='module')
def depth(gear):
    return build_water(gear).depth


@pytest.mark.parametrize('sample', SAMPLES, ids=lambda sample: type(sample).__name__)
def test_a_sensor_is_wrong_as_it_was_drawn(sample, depth):
    offsets = {name: 0.01 * (1 + number) for number, name in enumerate(NAMES)}
    scales = {name: 0.001 * (1 + number) for number, name in enumerate(NAMES)}
    shown = {each.channel: each for each in readings(
        miscalibrated(sample, depth, offsets, scales), depth)}  # fmt: skip
    for true in readings(sample, depth):
        there = true.value * (1.0 + scales.get(true.channel, 0.0)) + offsets.get(true.channel, 0.0)
        assert shown[true.channel].value == pytest.approx(there, rel=1e-6)
        assert shown[true.channel].std == pytest.approx(true.std, rel=1e-6)


@pytest.mark.parametrize('sample', UNTOUCHED, ids=lambda sample: type(sample).__name__)
def test_what_no_fit_reads_stays_as_it_is(sample, depth):
    assert (
        miscalibrated(sample, depth, dict.fromkeys(NAMES, 1.0), dict.fromkeys(NAMES, 0.1)) is sample
    )
