"""Each sample feeds the channels it should, in the unit the model speaks."""

import math

import numpy as np
import pytest

from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED, REQUIRED, readings
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    PressureSample,
    RangeSample,
    VelocitySample,
    WinchSample,
)


def fed(sea, sample):
    return {r.channel: r for r in readings(sample, sea.pressure_to_depth)}


def test_a_winch_sample_feeds_counters_and_load_cells(sea):
    found = fed(sea, WinchSample(7, (500.0, 501.0), (0.0, 0.0), (2e5, 2.1e5)))
    assert {name: reading.value for name, reading in found.items()} == {
        'port_length': 500.0,
        'starboard_length': 501.0,
        'port_tension': 2e5,
        'starboard_tension': 2.1e5,
    }
    assert all(reading.stamp == 7 for reading in found.values())


@pytest.mark.parametrize(
    ('place', 'channel'),
    [
        ('port', 'port_door_depth'),
        ('starboard', 'starboard_door_depth'),
        ('sonar', 'net_depth'),
    ],
)
def test_pressure_becomes_depth_and_its_noise_metres(sea, place, channel):
    sample = PressureSample(1, place, sea.depth_to_pressure(250.0), 1025.0 * 9.81 * 0.4)
    reading = fed(sea, sample)[channel]
    assert reading.value == pytest.approx(250.0)
    assert reading.std == pytest.approx(0.4)


def test_a_missing_pressure_stays_missing(sea):
    assert math.isnan(fed(sea, PressureSample(1, 'port', math.nan, 1.0))['port_door_depth'].value)


def test_attitude_spread_and_log(sea):
    attitude = fed(sea, AttitudeSample(1, 'starboard', 0.1, -0.2, 0.01))
    assert attitude['starboard_pitch'].value == 0.1
    assert attitude['starboard_roll'].value == -0.2
    spread = fed(sea, RangeSample(1, 'spread', 130.0, 1.0, 2.0, 400.0))['door_spread']
    assert (spread.value, spread.low, spread.high) == (130.0, 2.0, 400.0)
    water = VelocitySample(1, 'water', np.array([2.0, 0.3, 0.0]), 0.0)
    assert fed(sea, water)['speed'].value == 2.0


def test_speed_over_ground_is_a_witness_and_position_is_not_used(sea):
    ground = fed(sea, VelocitySample(1, 'ground', np.array([2.0, 0.5, 0.0]), 0.0))
    assert {name: reading.value for name, reading in ground.items()} == {
        'ground_east': 2.0,
        'ground_north': 0.5,
    }
    assert not set(ground) & {*INPUTS, *MEASURED}
    assert fed(sea, FixSample(1, 10.0, 20.0, 3.0)) == {}


def test_delays_leave_time_for_the_slowest_reading_on_its_way():
    options = WindowOptions()
    for channel in CHANNELS.values():
        if channel.name != 'vertical_opening':
            assert channel.delay >= 1.0 / channel.min_rate + options.reorder_s + 1.0
    assert max(channel.delay for channel in CHANNELS.values()) < options.settle_s / 4.0


def test_the_needed_channels_are_those_of_the_paper_and_the_inputs():
    assert set(REQUIRED) == {
        *INPUTS, 'port_tension', 'starboard_tension', 'port_door_depth',
        'starboard_door_depth', 'door_spread', 'net_depth',
    }  # fmt: skip
    assert set(REQUIRED) - set(INPUTS) < set(MEASURED)


def test_a_bias_has_an_absolute_and_a_relative_part():
    depth = CHANNELS['net_depth']
    assert depth.bias_std(0.0) == depth.bias
    assert depth.bias_std(1e5) == pytest.approx(1e5 * depth.bias_fraction, rel=1e-4)


def test_the_table_has_what_default_instruments_are_wrong_by_in_each_state():
    ship = load_instruments()
    for name, errors in (('port_length', ship.winch.length), ('door_spread', ship.door.spread)):
        channel = CHANNELS[name]
        assert errors.model().bias_std == channel.per_state == channel.state_std(0.5, share=0.3)


def test_where_no_error_of_a_state_was_measured_it_is_a_share_of_the_bias():
    assert CHANNELS['net_depth'].state_std(0.5, share=0.3) == pytest.approx(0.15)
    assert CHANNELS['door_spread'].state_std(0.5, share=0.0) == 0.0


def test_what_stays_wrong_through_a_state_is_calibration_and_what_changes_with_it():
    spread, depth = CHANNELS['door_spread'], CHANNELS['net_depth']
    assert spread.steady_std(100.0) == pytest.approx(math.hypot(0.5, 0.5, 0.6))
    assert depth.steady_std(100.0) == depth.bias_std(100.0)
