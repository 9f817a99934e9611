"""Readings with covariance: what robot_localization takes, with the stated noise."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.covariance_twins import covariance_twin
from trawl_ros.messages.pieces import UNKNOWN_VARIANCE
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.records.samples import PressureSample, RangeSample, VelocitySample
from trawl_ros.records.topics import CONTRACT, TOPICS, TWINS

STAMP = 12_345_000_000
LOG = VelocitySample(STAMP, 'water', np.array([2.1, 0.1, 0.0]), 0.01, (0.05, 0.002))
DEPTH = PressureSample(STAMP, 'port', 1.1e6, 2e3)


def depth(pressure):
    return (pressure - 1e5) / 1e4


def twin_of(sample):
    topic, message = covariance_twin(sample, depth)
    return topic, deserialize(serialize(message), TOPICS[topic].type)


@pytest.mark.parametrize(('over', 'frame'), [('water', 'vessel'), ('ground', 'map')])
def test_a_velocity_states_its_noise(over, frame):
    topic, message = twin_of(replace(LOG, over=over))
    assert topic == f'vessel/velocity_{over}_with_covariance'
    assert (message.header.frame_id, stamp_of(message)) == (frame, STAMP)
    twist, variances = message.twist.twist, np.diag(message.twist.covariance.reshape(6, 6))
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (2.1, 0.1, 0.01)
    np.testing.assert_allclose(variances[[0, 1, 5]], [0.05**2, 0.05**2, 0.002**2])
    assert set(variances[[2, 3, 4]]) == {UNKNOWN_VARIANCE}


def test_a_rate_of_turn_that_is_missing_is_unknown_and_no_nan():
    _, message = twin_of(replace(LOG, yaw_rate=math.nan))
    assert message.twist.twist.angular.z == 0.0
    assert message.twist.covariance.reshape(6, 6)[5, 5] == UNKNOWN_VARIANCE


@pytest.mark.parametrize(('place', 'name'), [('port', 'door/port'), ('sonar', 'sonar')])
def test_a_pressure_is_a_depth_below_map(place, name):
    topic, message = twin_of(replace(DEPTH, place=place))
    assert topic == f'{name}/depth_with_covariance'
    assert (message.header.frame_id, stamp_of(message)) == ('map', STAMP)
    assert message.pose.pose.position.z == pytest.approx(-100.0)
    variances = np.diag(message.pose.covariance.reshape(6, 6))
    assert variances[2] == pytest.approx(0.2**2)
    assert set(np.delete(variances, 2)) == {UNKNOWN_VARIANCE}


@pytest.mark.parametrize(
    'sample',
    [
        replace(LOG, stated=(0.0, 0.0)),
        replace(LOG, velocity=np.array([math.nan, 0.0, 0.0])),
        replace(DEPTH, std=0.0),
        replace(DEPTH, pressure=math.nan),
        RangeSample(STAMP, 'spread', 100.0, 1.0, 1.0, 400.0),
    ],
)
def test_nothing_is_said_without_a_reading_or_a_stated_noise(sample):
    assert covariance_twin(sample, depth) is None


def test_twins_are_found_by_name_and_not_recorded_unless_asked():
    assert not {row.name for row in TWINS} & {row.name for row in CONTRACT}
    assert all(TOPICS[row.name] is row for row in TWINS)
