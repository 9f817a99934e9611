"""Truth becomes messages on every truth topic, and its pieces come back as they were."""

import dataclasses

import numpy as np
import pytest
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.errors import MessageError
from trawl_ros.core.rotations import to_quaternion
from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.markers import FULL_SCALE, gear_markers, tension_colours
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.transforms import rename_frames, transforms_message
from trawl_ros.messages.truth_from_messages import (
    door_truth,
    net_truth,
    observables_truth,
    schools_truth,
    seabed_truth,
    vessel_truth,
    winch_truth,
)
from trawl_ros.messages.truth_to_messages import clock_message, truth_messages
from trawl_ros.records.frames import FRAME_SENTENCES
from trawl_ros.records.observables import OBSERVABLES, Observables
from trawl_ros.records.topics import TOPICS, TRUTH
from trawl_ros.records.truth import (
    DoorTruth,
    GearPicture,
    NetTruth,
    Polyline,
    SchoolTruth,
    SeabedTruth,
    Truth,
    VesselTruth,
    WinchTruth,
)

STAMP = 12_300_000_000


def door(y: float) -> DoorTruth:
    return DoorTruth(
        position=np.array([-480.0, y, -135.0]),
        orientation=np.array(to_quaternion(0.1, -0.05, 0.3)),
        velocity=np.array([2.0, 0.1, -0.02]),
        angular_velocity=np.array([0.001, 0.002, 0.003]),
        attack=0.45,
        slip=-0.02,
        inclination=0.2,
        force=np.array([-2e4, 5e4, 3e3]),
        moment=np.array([1e3, -2e3, 500.0]),
    )


DOORS = (door(60.0), door(-60.0))

TRUTH_RECORD = Truth(
    stamp=STAMP,
    doors=DOORS,
    winches=(WinchTruth(500.0, 0.5, 8e4), WinchTruth(502.0, -0.5, 7.9e4)),
    net=NetTruth(
        mouth=np.arange(18.0).reshape(6, 3),
        horizontal_opening=42.0,
        vertical_opening=21.0,
        headrope_depth=140.0,
        sonar_position=np.array([-620.0, 0.5, -140.0]),
        sonar_orientation=np.array(to_quaternion(0.0, np.pi / 2, 0.0)),
        section=np.array([[0.5, 12.0, 0.125], [40.0, -12.0, 0.25], [44.0, 0.0, 0.0625]]),
    ),
    vessel=VesselTruth(
        position=np.array([10.0, 20.0, 2.0]),
        heading=2.5,
        yaw_rate=0.01,
        velocity_ground=np.array([-1.6, 1.2, 0.0]),
        velocity_water=np.array([2.1, 0.05, 0.0]),
    ),
    schools=(SchoolTruth(np.array([50.0, 0.0, -140.0]), np.array([80.0, 40.0, 20.0]), 0.25),),
    seabed=SeabedTruth(250.0, 240.0),
    observables=Observables(*np.linspace(0.25, 5.5, len(OBSERVABLES))),
)


@pytest.fixture(scope='module')
def received():
    return {
        topic: deserialize(serialize(message), TOPICS[topic].type)
        for topic, message in truth_messages(TRUTH_RECORD)
    }


def assert_close(record, expected):
    for field in dataclasses.fields(expected):
        first, second = getattr(record, field.name), getattr(expected, field.name)
        np.testing.assert_allclose(first, second, rtol=1e-12, atol=1e-12, err_msg=field.name)


def test_every_truth_topic_but_the_markers_is_there(received):
    assert set(received) == {topic.name for topic in TRUTH} - {'truth/gear'}


def test_stamps_and_frames_are_those_of_the_table(received):
    for topic, message in received.items():
        assert stamp_of(message) == STAMP
        assert message.header.frame_id == TOPICS[topic].frame


@pytest.mark.parametrize(('side', 'expected'), [('port', DOORS[0]), ('starboard', DOORS[1])])
def test_doors_come_back(received, side, expected):
    parts = (received[f'truth/door/{side}/{what}'] for what in ('odom', 'angles', 'wrench'))
    assert_close(door_truth(f'truth/door/{side}/odom', *parts), expected)


def test_a_door_without_its_wrench_does_not_pretend_to_know_it(received):
    found = door_truth('truth/door/port/odom', received['truth/door/port/odom'])
    assert np.isnan(found.force).all()
    assert np.isnan(found.attack)
    np.testing.assert_allclose(found.position, DOORS[0].position)


def test_schools_and_seabed_come_back(received):
    assert seabed_truth(received['truth/seabed']) == TRUTH_RECORD.seabed
    (found,) = schools_truth(received['truth/schools'])
    assert_close(found, TRUTH_RECORD.schools[0])


def test_observables_come_back_and_those_that_are_missing_are_nan(received):
    message = received['truth/observables']
    assert observables_truth(message) == TRUTH_RECORD.observables
    message.name[0] = 'of_another_model'
    assert np.isnan(observables_truth(message).door_spread)


def test_the_opening_in_the_sonars_plane_is_read_off_its_section(received):
    seen = received['truth/sonar/opening'].vector
    assert (seen.x, seen.y) == (44.0, 24.0)


def test_odometry_names_the_body_it_speaks_of(received):
    assert received['truth/door/starboard/odom'].child_frame_id == 'door_starboard'
    assert received['truth/vessel/odom'].child_frame_id == 'vessel'


def test_winches_come_back_whatever_their_order(received):
    message = received['truth/winch']
    order = [1, 0]
    shuffled = ros.sensor_msgs__msg__JointState(
        message.header,
        [message.name[i] for i in order],
        message.position[order],
        message.velocity[order],
        message.effort[order],
    )
    assert winch_truth('truth/winch', message) == TRUTH_RECORD.winches
    assert winch_truth('truth/winch', shuffled) == TRUTH_RECORD.winches


def test_the_net_comes_back(received):
    found = net_truth(
        received['truth/net/opening'],
        received['truth/sonar/pose'],
        received['truth/net/mouth'],
        received['truth/sonar/section'],
    )
    assert_close(found, TRUTH_RECORD.net)


def test_the_ship_comes_back(received):
    found = vessel_truth(received['truth/vessel/odom'], received['truth/vessel/velocity_water'])
    assert_close(found, TRUTH_RECORD.vessel)


def test_the_ships_odometry_has_its_velocity_in_the_ships_frame(received):
    forward = received['truth/vessel/odom'].twist.twist.linear.x
    heading, over_ground = TRUTH_RECORD.vessel.heading, TRUTH_RECORD.vessel.velocity_ground
    assert forward == pytest.approx(over_ground @ [np.cos(heading), np.sin(heading), 0.0])


def test_an_uninitialised_orientation_is_refused(received):
    message = received['truth/door/port/odom']
    broken = dataclasses.replace(
        message,
        pose=ros.geometry_msgs__msg__PoseWithCovariance(
            ros.geometry_msgs__msg__Pose(
                message.pose.pose.position, ros.geometry_msgs__msg__Quaternion(0.0, 0.0, 0.0, 0.0)
            ),
            message.pose.covariance,
        ),
    )
    with pytest.raises(MessageError, match='truth/door/port/odom: orientation'):
        door_truth('truth/door/port/odom', broken)


def test_the_clock_is_the_stamp():
    topic, message = clock_message(STAMP)
    assert topic == '/clock'
    assert (message.clock.sec, message.clock.nanosec) == (12, 300_000_000)


PICTURE = GearPicture(
    stamp=STAMP,
    lines=(
        Polyline('port_warp', np.arange(12.0).reshape(4, 3), 8e4),
        Polyline('net', np.zeros((3, 3)), 2e3),
        Polyline('net', np.ones((5, 3)), 1e3),
    ),
    doors=DOORS,
    door_size=(2.14, 4.3),
)


def drawn():
    _, message = gear_markers(PICTURE)
    return deserialize(serialize(message), message.__msgtype__)


def test_markers_replace_those_of_the_picture_before():
    names = [[(m.ns, m.id) for m in drawn().markers] for _ in range(2)]
    assert names[0] == names[1]
    assert len(set(names[0])) == len(names[0]) == 4


def test_lines_of_one_name_are_one_marker_with_a_colour_per_line():
    net = drawn().markers[1]
    assert net.type == ros.visualization_msgs__msg__Marker.LINE_LIST
    segments = sum(len(line.points) - 1 for line in PICTURE.lines if line.name == 'net')
    assert len(net.points) == len(net.colors) == 2 * segments
    first, second = (line for line in PICTURE.lines if line.name == 'net')
    shown = [(colour.r, colour.g, colour.b, colour.a) for colour in net.colors]
    wanted = tension_colours(np.array([first.tension, second.tension]))
    assert np.allclose([shown[0], shown[-1]], wanted)
    assert (net.points[0].x, net.points[-1].x) == (first.points[0, 0], second.points[-1, 0])


def test_markers_are_encoded_as_any_message_is():
    topic, message = gear_markers(PICTURE)
    back = deserialize(serialize(message), TOPICS[topic].type)
    assert serialize(back) == serialize(message)
    warp, *_, port_door, _ = back.markers
    assert [(p.x, p.y, p.z) for p in warp.points] == [tuple(p) for p in PICTURE.lines[0].points]
    assert warp.type == ros.visualization_msgs__msg__Marker.LINE_STRIP
    assert port_door.type == ros.visualization_msgs__msg__Marker.CUBE
    assert (port_door.scale.x, port_door.scale.z) == PICTURE.door_size
    assert port_door.pose.position.x == DOORS[0].position[0]
    assert {marker.header.frame_id for marker in back.markers} == {'map'}


def test_tension_runs_from_blue_to_red():
    slack, full, beyond = tension_colours(np.array([0.0, FULL_SCALE, 2 * FULL_SCALE])).tolist()
    assert slack[2] > slack[0]
    assert full[0] > full[2]
    assert beyond == full


def test_transforms_say_the_same_as_the_poses(received):
    topic, message = transforms_message(TRUTH_RECORD)
    back = deserialize(serialize(message), TOPICS[topic].type)
    found = {entry.child_frame_id: entry for entry in back.transforms}
    assert set(found) == {'vessel', 'sonar', 'door_port', 'door_starboard'}
    for frame, pose in {
        'vessel': received['truth/vessel/odom'].pose.pose,
        'door_port': received['truth/door/port/odom'].pose.pose,
        'door_starboard': received['truth/door/starboard/odom'].pose.pose,
        'sonar': received['truth/sonar/pose'].pose,
    }.items():
        entry = found[frame]
        assert (entry.header.frame_id, stamp_of(entry)) == ('map', STAMP)
        moved, turned = entry.transform.translation, entry.transform.rotation
        assert (moved.x, moved.y, moved.z) == (pose.position.x, pose.position.y, pose.position.z)
        assert turned == pose.orientation


def test_the_ship_is_left_to_an_estimator_of_poses_where_asked():
    _, message = transforms_message(TRUTH_RECORD, ship=False)
    assert {entry.child_frame_id for entry in message.transforms} == {
        'sonar',
        'door_port',
        'door_starboard',
    }


def test_transforms_of_two_ships_are_one_tree_each():
    def edges(prefix):
        _, message = transforms_message(TRUTH_RECORD, odom=True)
        names = {frame: f'{prefix}{frame}' for frame in FRAME_SENTENCES if frame != 'map'}
        rename_frames(message, names)
        return {entry.child_frame_id: entry.header.frame_id for entry in message.transforms}

    one, two = edges('a/'), edges('b/')
    assert not one.keys() & two.keys()
    assert one['a/vessel'] == 'a/odom'
    assert one['a/odom'] == one['a/sonar'] == 'map'
