"""The URDF has the frames of the project, each mounted as the nodes say on /tf_static."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from trawl_ros.core.resources import share_path
from trawl_ros.core.rotations import to_quaternion
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.messages.transforms import mounts_message
from trawl_ros.records.frames import (
    DOOR_MOUNTS,
    FRAME_SENTENCES,
    WIDTH_MOUNT,
    echo_sounder_mount,
)
from trawl_ros.records.topics import MAP, ODOM, SONAR, TOPICS, VESSEL

ROOT = ET.parse(share_path('config', 'urdf', 'trawl.urdf')).getroot()
JOINTS = list(ROOT.iter('joint'))
MOUNTS = (
    echo_sounder_mount(load_instruments().vessel.draught_m),
    *DOOR_MOUNTS,
    WIDTH_MOUNT,
)


def numbers(element, key):
    return tuple(map(float, element.get(key, '0 0 0').split()))


def axes(quaternion):
    """Axes x, y, z in the parent, as columns."""
    x, y, z, w = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip


def test_it_has_every_frame_but_the_fixed_ones():
    assert {link.get('name') for link in ROOT.iter('link')} == set(FRAME_SENTENCES) - {MAP, ODOM}


def test_it_is_a_tree_from_the_ship():
    parents = {
        j.find('child').get('link'): j.find('parent').get('link') for j in ROOT.iter('joint')
    }
    links = {link.get('name') for link in ROOT.iter('link')}
    assert links - set(parents) == {VESSEL}
    assert set(parents.values()) <= links


def test_sensors_are_mounted_as_nodes_say():
    fixed = {
        joint.find('child').get('link'): (
            joint.find('parent').get('link'),
            *(numbers(joint.find('origin'), key) for key in ('xyz', 'rpy')),
        )
        for joint in JOINTS
        if joint.get('type') == 'fixed'
    }
    assert fixed == {
        mount.frame: (mount.parent, pytest.approx(mount.position), pytest.approx(mount.angles))
        for mount in MOUNTS
    }


@pytest.mark.parametrize(
    ('frame', 'parent', 'x'),
    [
        ('echo_sounder', VESSEL, (0, 0, -1)),
        ('door_port_spread', 'door_port', (0, -1, 0)),
        ('sonar_width', SONAR, (0, 1, 0)),
    ],
)
def test_a_range_is_measured_along_x_of_its_frame(frame, parent, x):
    _, message = mounts_message(0, MOUNTS)
    (found,) = (entry for entry in message.transforms if entry.child_frame_id == frame)
    assert found.header.frame_id == parent
    q = found.transform.rotation
    np.testing.assert_allclose(axes((q.x, q.y, q.z, q.w))[:, 0], x, atol=1e-12)


def test_every_range_has_a_frame_whose_x_it_is_measured_along():
    # x of frame sonar points down as it is.
    along_x = {mount.frame for mount in MOUNTS} | {SONAR}
    ranges = [row for row in TOPICS.values() if row.type == 'sensor_msgs/msg/Range']
    assert {row.frame for row in ranges} <= along_x
    assert TOPICS['door/spread'].frame == 'door_port_spread'
    assert {TOPICS[f'vessel/echo_sounder/{what}'].frame for what in ('depth', 'school')} == {
        'echo_sounder'
    }


def test_angles_of_a_mount_are_turned_as_rep_103_has_it():
    assert to_quaternion(0, 0, np.pi / 2) == pytest.approx((0, 0, np.sqrt(0.5), np.sqrt(0.5)))
