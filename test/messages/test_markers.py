"""The ship among the markers: where the warps leave her, and as long as stated."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from trawl_ros.messages.cdr import deserialize, serialize
from trawl_ros.messages.markers import VESSEL_LENGTH, gear_markers
from trawl_ros.records.truth import DoorTruth, GearPicture, Polyline, SchoolTruth

DOOR = DoorTruth(
    position=np.array([-500.0, 30.0, -100.0]),
    orientation=np.array([0.0, 0.0, 0.0, 1.0]),
    velocity=np.zeros(3),
    angular_velocity=np.zeros(3),
    attack=0.3,
    slip=0.0,
    inclination=0.1,
    force=np.zeros(3),
    moment=np.zeros(3),
)
HEADING = np.radians(30.0)
AHEAD = np.array([np.cos(HEADING), np.sin(HEADING), 0.0])
PORT = np.array([-np.sin(HEADING), np.cos(HEADING), 0.0])
STERN = np.array([10.0, 20.0, 0.0])


def drawn(picture: GearPicture) -> Any:
    _, message = gear_markers(picture)
    return deserialize(serialize(message), message.__msgtype__)


def _picture(*names: str) -> GearPicture:
    ends = {'port_warp': STERN + 6.0 * PORT, 'starboard_warp': STERN - 6.0 * PORT}
    lines = tuple(
        Polyline(name, np.array([ends[name], ends[name] - 100.0 * AHEAD]), 1e4) for name in names
    )
    return GearPicture(stamp=0, lines=lines, doors=(DOOR, DOOR), door_size=(2.0, 4.0))


def test_the_hull_lies_ahead_of_the_blocks_along_the_heading():
    array = drawn(_picture('port_warp', 'starboard_warp'))
    (hull,) = (marker for marker in array.markers if marker.ns == 'vessel')
    points = np.array([[p.x, p.y, p.z] for p in hull.points]) - STERN
    along, across = points @ AHEAD, points @ PORT
    assert (along.min(), along.max()) == pytest.approx((0.0, VESSEL_LENGTH))
    assert (across.min(), across.max()) == pytest.approx((-10.0, 10.0))
    assert np.allclose(points[:, 2], 0.0)
    np.testing.assert_allclose(points[0], points[-1])


def test_without_both_warps_nobody_knows_where_the_ship_is():
    array = drawn(_picture('port_warp'))
    assert 'vessel' not in {marker.ns for marker in array.markers}


def test_schools_are_ellipsoids_that_viewers_tell_apart():
    fish = tuple(
        SchoolTruth(np.array([north, 5.0, -90.0]), np.array([60.0, 40.0, 20.0]), 1.0)
        for north in (100.0, 300.0)
    )
    array = drawn(replace(_picture(), schools=fish))
    schools = [marker for marker in array.markers if marker.ns == 'schools']
    assert [marker.id for marker in schools] == [0, 1]
    second = schools[1]
    assert second.type == second.SPHERE
    assert (second.pose.position.x, second.pose.position.z) == (300.0, -90.0)
    assert (second.scale.x, second.scale.y, second.scale.z) == (60.0, 40.0, 20.0)
    assert 0.0 < second.color.a < 1.0
