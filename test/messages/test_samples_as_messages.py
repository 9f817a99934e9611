"""Samples become messages as the contract says, and come back as they were."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.registry import changed, with_numbers
from trawl_ros.records.samples import (
    AttitudeSample,
    FixSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    SchoolsSample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.sensors import INSTRUMENTS
from trawl_ros.records.topics import TOPICS

STAMP = 1_785_000_000_123_456_789

SAMPLES = [
    WinchSample(STAMP, (500.25, 501.5), (0.5, -0.25), (81e3, 79.5e3)),
    PressureSample(STAMP, 'port', 1.35e6, 2500.0),
    PressureSample(STAMP, 'starboard', 1.36e6, 2500.0),
    PressureSample(STAMP, 'sonar', 1.41e6, 1200.0),
    AttitudeSample(STAMP, 'port', 0.08, -0.21, 0.01),
    AttitudeSample(STAMP, 'starboard', -0.05, 0.17, 0.01),
    RangeSample(STAMP, 'spread', 118.75, 0.5, 5.0, 400.0),
    RangeSample(STAMP, 'opening_height', 22.5, 0.5, 1.0, 120.0),
    RangeSample(STAMP, 'opening_width', 41.25, 0.75, 1.0, 120.0),
    VelocitySample(STAMP, 'water', np.array([2.05, 0.01, 0.0]), math.nan),
    VelocitySample(STAMP, 'ground', np.array([1.4, 1.5, 0.0]), 0.01),
    HeadingSample(STAMP, 2.9, 0.01),
    FixSample(STAMP, 57.75, -152.5, 3.0),
    RangeSample(STAMP, 'bottom', 61.5, 0.25, 1.0, 200.0),
    RangeSample(STAMP, 'depth', 240.5, 0.5, 1.0, 1000.0),
    RangeSample(STAMP, 'school', math.inf, 0.5, 1.0, 1000.0),
    SonarImageSample(STAMP, np.arange(12, dtype=np.uint8).reshape(3, 4)),
    SonarScanSample(
        STAMP, np.array([4.5, math.inf]), np.array([200.0, 0.0]), -1.5, 0.75, 1.0, 100.0, 10.0
    ),
    SchoolsSample(STAMP, np.array([[1200.0, -30.0, -150.0]])),
    SonarPointsSample(STAMP, np.array([[1.0, 2.0, -3.0, 120.0], [4.0, 5.0, -6.0, 7.0]])),
]


SAMPLES += [
    with_numbers(
        changed(row.blank, stamp=STAMP), {field: 0.25 + n for n, field in enumerate(row.fields)}
    )
    for row in INSTRUMENTS
    if row.errors
]
"""Those of sensors that only measure observables have numbers of their own, each another."""


def through_bytes(sample):
    topic, message = sample_message(sample)
    data = serialize(message)
    return topic, deserialize(data, TOPICS[topic].type)


def assert_same(one, other):
    assert type(one) is type(other)
    for field in dataclasses.fields(one):
        first, second = getattr(one, field.name), getattr(other, field.name)
        if isinstance(first, str | int):
            assert first == second, field.name
        else:
            # Range has 32-bit fields; variances are squares of what went in.
            np.testing.assert_allclose(second, first, rtol=1e-7, err_msg=field.name)


@pytest.mark.parametrize('sample', SAMPLES, ids=lambda s: sample_message(s)[0])
def test_a_sample_survives_the_way_through_message_and_bytes(sample):
    assert_same(sample, to_sample(*through_bytes(sample)))


def test_every_topic_with_samples_is_tried_here():
    assert {sample_message(sample)[0] for sample in SAMPLES} == set(SAMPLE_TOPICS)


@pytest.mark.parametrize('sample', SAMPLES, ids=lambda s: sample_message(s)[0])
def test_type_frame_and_stamp_are_those_of_the_table(sample):
    topic, message = sample_message(sample)
    assert message.__msgtype__ == TOPICS[topic].type
    assert message.header.frame_id == TOPICS[topic].frame
    assert stamp_of(message) == STAMP


def test_an_inclinometer_knows_neither_yaw_nor_rates():
    _, imu = sample_message(AttitudeSample(STAMP, 'port', 0.1, 0.2, 0.01))
    roll, pitch, yaw = imu.orientation_covariance.reshape(3, 3).diagonal()
    assert roll == pitch == pytest.approx(1e-4)
    assert yaw > 1e3
    assert imu.angular_velocity_covariance[0] == -1
    assert imu.linear_acceleration_covariance[0] == -1


def test_positive_pitch_is_nose_down_and_positive_roll_leans_the_top_to_starboard():
    def axis(sample, vector):
        q = sample_message(sample)[1].orientation
        v, u = np.array(vector), np.array([q.x, q.y, q.z])
        return v + 2 * np.cross(u, np.cross(u, v) + q.w * v)

    nose = axis(AttitudeSample(STAMP, 'port', 0.1, 0.0, 0.01), (1.0, 0.0, 0.0))
    top = axis(AttitudeSample(STAMP, 'port', 0.0, 0.1, 0.01), (0.0, 0.0, 1.0))
    assert nose[2] == pytest.approx(-math.sin(0.1))
    assert top[1] == pytest.approx(-math.sin(0.1)), 'y is port'


def test_a_range_states_what_kind_of_sensor_it_is():
    _, message = sample_message(RangeSample(STAMP, 'spread', 100.0, 0.5, 5.0, 400.0))
    assert message.radiation_type == ros.sensor_msgs__msg__Range.ULTRASOUND
    assert message.field_of_view > 0
    assert (message.min_range, message.max_range) == (5.0, 400.0)
    assert message.variance == 0.25


@pytest.mark.parametrize('missing', [math.nan, math.inf, -math.inf])
def test_a_missing_range_stays_missing(missing):
    sample = RangeSample(STAMP, 'spread', missing, 0.5, 5.0, 400.0)
    back = to_sample(*through_bytes(sample))
    assert back.distance == missing or (math.isnan(back.distance) and math.isnan(missing))


def test_a_missing_attitude_stays_missing():
    back = to_sample(*through_bytes(AttitudeSample(STAMP, 'port', math.nan, math.nan, 0.01)))
    assert math.isnan(back.pitch)
    assert math.isnan(back.roll)


def test_a_missing_fix_says_that_there_is_none():
    topic, message = through_bytes(FixSample(STAMP, math.nan, math.nan, 3.0))
    assert message.status.status == ros.sensor_msgs__msg__NavSatStatus.STATUS_NO_FIX
    assert math.isnan(to_sample(topic, message).latitude)


def test_an_orientation_said_to_be_absent_is_a_missing_attitude():
    topic, imu = sample_message(AttitudeSample(STAMP, 'port', 0.1, 0.2, 0.01))
    imu.orientation_covariance[0] = -1
    assert math.isnan(to_sample(topic, imu).pitch)


def test_winches_are_told_apart_by_name():
    topic, message = sample_message(SAMPLES[0])
    message.name.reverse()
    back = to_sample(topic, message)
    assert back.lengths == (501.5, 500.25)


def test_winches_without_load_cell_have_missing_tensions():
    topic, message = sample_message(SAMPLES[0])
    message.effort = np.zeros(0)
    assert np.isnan(to_sample(topic, message).tensions).all()


def test_a_range_of_an_older_distribution_has_no_variance():
    old = sample_message(RangeSample(STAMP, 'spread', 100.0, 0.5, 5.0, 400.0))[1]
    fields = ('header', 'range', 'min_range', 'max_range')
    message = SimpleNamespace(**{name: getattr(old, name) for name in fields})
    assert to_sample('door/spread', message).std == 0.0


def joint_state_named(*names):
    message = sample_message(SAMPLES[0])[1]
    message.name = list(names)
    return message


def imu_with_zero_quaternion():
    message = sample_message(SAMPLES[4])[1]
    message.orientation.w = message.orientation.x = message.orientation.y = 0.0
    return message


def pressure_of_negative_variance():
    message = sample_message(SAMPLES[1])[1]
    message.variance = -4.0
    return message


def fix_beyond_the_pole():
    message = sample_message(next(s for s in SAMPLES if isinstance(s, FixSample)))[1]
    message.latitude = 123.0
    return message


@pytest.mark.parametrize(
    ('topic', 'message', 'words'),
    [
        ('winch/joint_states', joint_state_named('port_warp', 'third'), 'no starboard_warp'),
        ('winch/joint_states', joint_state_named('port_warp', 'starboard_warp', 'x'), '2 entries'),
        ('door/port/attitude', imu_with_zero_quaternion(), 'not a unit quaternion'),
        ('door/port/pressure', pressure_of_negative_variance(), 'variance -4'),
        ('vessel/fix', fix_beyond_the_pole(), 'latitude 123'),
        (
            'truth/winch',
            joint_state_named('port_warp', 'starboard_warp'),
            'not a topic',
        ),
    ],
)
def test_what_contradicts_the_topic_is_refused_by_name(topic, message, words):
    with pytest.raises(MessageError, match=words) as caught:
        to_sample(topic, message)
    assert str(caught.value).startswith(topic)
