"""Every topic keeps to the REPs: 103 units, 105 frames, 107 diagnostics, 117 ranges, 147 types."""

import math
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.geodesy import Datum, to_latitude_longitude
from trawl_ros.core.rotations import to_angles, to_quaternion
from trawl_ros.messages.cdr import STORE
from trawl_ros.messages.diagnostics import ERROR, OK, STALE, WARN
from trawl_ros.messages.fields import fields_of
from trawl_ros.messages.pieces import ABSENT, UNKNOWN_VARIANCE
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.frames import (
    DOOR_MOUNTS,
    FRAME_SENTENCES,
    WIDTH_MOUNT,
    echo_sounder_mount,
)
from trawl_ros.records.registry import DOOR_FRAMES, MAP, ODOM, SONAR, VESSEL, with_numbers
from trawl_ros.records.sensors import SENSORS
from trawl_ros.records.topics import COMMANDS, ESTIMATES, INSTRUMENTS, TOPICS, TRUTH, TWINS

STAMPED = [row for row in (*TRUTH, *INSTRUMENTS, *TWINS, *COMMANDS) if row.frame]
MEASURED = [row for row in INSTRUMENTS if row.fields]
RANGES = [row for row in INSTRUMENTS if row.type == 'sensor_msgs/msg/Range']
ON_SHIP, ON_GEAR = (VESSEL, MAP), (*DOOR_FRAMES.values(), SONAR, MAP)


def message_of(row, value=0.25):
    """Message of a sensor whose numbers are all the same."""
    sample = with_numbers(row.blank, dict.fromkeys(row.fields, value))
    if row.states_noise:
        sample = replace(sample, std=0.5)
    if row.is_range:
        sample = replace(sample, min_range=0.1, max_range=400.0)
    return sample_message(sample)[1]


def parts(message, name):
    """Parts of a message with an attribute, those of nested messages too."""
    return [getattr(owner, name) for owner, attribute in fields_of(message) if attribute == name]


@pytest.mark.parametrize('row', MEASURED, ids=lambda row: row.name)
def test_rep_103_values_are_si_and_orientations_are_unit_quaternions(row):
    message = message_of(row)
    numbers = [field.get(with_numbers(row.blank, {field: 0.25})) for field in row.fields]
    # The number of the sample goes out as it is: SI, and degrees only in a NavSatFix.
    assert set(numbers) == {0.25}
    if hasattr(message, 'orientation'):
        q = message.orientation
        assert q.x**2 + q.y**2 + q.z**2 + q.w**2 == pytest.approx(1.0)
        angles = dict(zip(('roll', 'pitch', 'yaw'), to_angles((q.x, q.y, q.z, q.w)), strict=True))
        assert [angles[field.at] for field in row.fields] == pytest.approx([0.25] * len(row.fields))


@pytest.mark.parametrize('row', MEASURED, ids=lambda row: row.name)
def test_rep_103_covariances_are_the_stated_noise_row_major(row):
    message = message_of(row)
    for name in ('orientation_covariance', 'position_covariance'):
        for covariance in parts(message, name):
            matrix = np.asarray(covariance).reshape(3, 3)
            np.testing.assert_array_equal(matrix, np.diag(np.diag(matrix)))
            assert set(np.diag(matrix)) <= {0.25, UNKNOWN_VARIANCE}
    # Quantities that a sensor does not have are marked as sensor_msgs/Imu wants it.
    for name in ('angular_velocity_covariance', 'linear_acceleration_covariance'):
        assert all(covariance[0] == ABSENT for covariance in parts(message, name))
    assert all(variance in (0.0, 0.25) for variance in parts(message, 'variance'))


def test_rep_103_and_105_east_is_yaw_0_and_north_is_to_port():
    assert to_quaternion(0.0, 0.0, 0.0) == (0.0, 0.0, 0.0, 1.0)
    turned = to_quaternion(0.0, 0.0, math.pi / 2)
    assert turned[2] > 0.0
    datum = Datum(60.0, 5.0)
    north = to_latitude_longitude(np.array([0.0, 100.0, 0.0]), datum)
    east = to_latitude_longitude(np.array([100.0, 0.0, 0.0]), datum)
    assert north[0] > 60.0
    assert east[1] > 5.0


@pytest.mark.parametrize('row', STAMPED, ids=lambda row: row.name)
def test_rep_105_a_frame_is_one_of_the_tree(row):
    assert row.frame in FRAME_SENTENCES
    assert STORE.fielddefs[row.type][1][0][0] == 'header'


def test_rep_105_frames_are_one_tree_from_map():
    parents = {mount.frame: mount.parent for mount in (
        echo_sounder_mount(6.5), *DOOR_MOUNTS, WIDTH_MOUNT,
    )}  # fmt: skip
    parents |= {VESSEL: ODOM, ODOM: MAP, SONAR: MAP, **dict.fromkeys(DOOR_FRAMES.values(), MAP)}
    assert set(parents) == set(FRAME_SENTENCES) - {MAP}
    for frame in parents:
        way = [frame]
        while way[-1] != MAP:
            way.append(parents[way[-1]])
            assert len(way) < 5


def test_rep_107_states_are_diagnostics_with_its_levels():
    assert (OK, WARN, ERROR, STALE) == (0, 1, 2, 3)
    assert TOPICS['/diagnostics'].rate == 1.0
    by_name = [row for row in (*ESTIMATES, *TWINS) if row.name.endswith(('status', 'findings'))]
    assert {row.type for row in by_name} == {'diagnostic_msgs/msg/DiagnosticArray'}


@pytest.mark.parametrize('row', RANGES, ids=lambda row: row.name)
@pytest.mark.parametrize('distance', [math.inf, -math.inf, math.nan])
def test_rep_117_ranges_that_are_none_are_infinite_or_nan(row, distance):
    message = message_of(row, distance)
    np.testing.assert_equal(message.range, distance)
    assert 0.0 <= message.min_range < message.max_range < math.inf
    assert message.field_of_view > 0.0
    assert message.radiation_type == message.ULTRASOUND


def test_rep_117_a_ray_without_an_echo_is_infinite():
    row = SENSORS['sonar/scan']
    scan = replace(
        row.blank, ranges=np.array([10.0, math.inf]), intensities=np.array([255.0, 0.0]),
        angle_increment=0.1, max_range=200.0, sweep_s=4.0,
    )  # fmt: skip
    message = sample_message(scan)[1]
    assert list(message.ranges) == [10.0, math.inf]
    assert message.angle_max == pytest.approx(message.angle_min + message.angle_increment)
    assert message.time_increment * len(message.ranges) == pytest.approx(message.scan_time)


@pytest.mark.parametrize(
    ('topics', 'type_name', 'frames'),
    [
        (('vessel/fix',), 'sensor_msgs/msg/NavSatFix', ON_SHIP),
        (('truth/vessel/odom', *(f'truth/door/{side}/odom' for side in DOOR_FRAMES)),
         'nav_msgs/msg/Odometry', (MAP,)),
        (('command/vessel',), 'geometry_msgs/msg/TwistStamped', (VESSEL,)),
        (('vessel/velocity_water_with_covariance', 'vessel/velocity_ground_with_covariance'),
         'geometry_msgs/msg/TwistWithCovarianceStamped', ON_SHIP),
        (('vessel/heading',), 'sensor_msgs/msg/Imu', ON_SHIP),
        (('sonar/pressure', 'door/port/pressure', 'door/starboard/pressure'),
         'sensor_msgs/msg/FluidPressure', ON_GEAR),
        (('sonar/depth_with_covariance', 'door/port/depth_with_covariance'),
         'geometry_msgs/msg/PoseWithCovarianceStamped', ON_GEAR),
    ],
)  # fmt: skip
def test_rep_147_and_robot_localization_take_these_types(topics, type_name, frames):
    for topic in topics:
        assert TOPICS[topic].type == type_name
        assert TOPICS[topic].frame in frames
