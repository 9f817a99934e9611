"""Frames of a graph have the names that are given; two ships in one graph do not mix."""

import math
import sys
from functools import partial
from types import ModuleType, SimpleNamespace

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from visualization_msgs.msg import MarkerArray

from trawl_ros.core.geodesy import Datum, to_latitude_longitude
from trawl_ros.nodes.door_sensor_node import DoorSensorNode
from trawl_ros.nodes.graph.source import with_history
from trawl_ros.nodes.nmea_in import NmeaIn
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import ParameterError
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.nodes.runtime.transforms import ShipPose
from trawl_ros.nodes.sim_node import SimNode
from trawl_ros.nodes.vessel_node import VesselNode
from trawl_ros.nodes.winch_node import WinchNode
from trawl_ros.records.samples import FixSample, HeadingSample
from trawl_ros.records.topics import STATIC_TRANSFORMS, TOPICS, TRANSFORMS

pytestmark = pytest.mark.ros

SECOND = 1_000_000_000
SHIPS = {'ship_a': 301.0, 'ship_b': 299.0}
"""Warp length by namespace, m."""

HEARD = (
    'truth/winch',
    'truth/vessel/odom',
    'truth/door/port/odom',
    'truth/gear',
    'winch/joint_states',
    'vessel/heading',
    'vessel/echo_sounder/depth',
    'door/spread',
)


class Listener(TrawlNode):
    """Keeps the last message of each topic, by namespace, and the parents of frames."""

    def __init__(self, **kwargs):
        super().__init__('listener', **kwargs)
        self.last, self.parents = {}, {}
        self.listen(TRANSFORMS.name, self._see, CONSUMER)
        self.listen(STATIC_TRANSFORMS.name, self._see, with_history(CONSUMER))
        for ship in SHIPS:
            for topic in HEARD:
                full = f'/{ship}/{topic}'
                take = partial(self.last.__setitem__, (ship, topic))
                self.listen(full, take, CONSUMER, TOPICS[topic].type)

    def _see(self, message):
        for entry in message.transforms:
            self.parents[entry.child_frame_id] = entry.header.frame_id


@pytest.fixture(scope='module')
def transform_type():
    """Stand-in for the type of tf2_msgs, which is in no package index: its bytes are the real ones.

    ROS passes bytes on as they are, so any type does for what is published and heard as bytes.
    """
    messages = ModuleType('tf2_msgs.msg')
    messages.TFMessage = MarkerArray
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, 'tf2_msgs', ModuleType('tf2_msgs'))
        patch.setitem(sys.modules, 'tf2_msgs.msg', messages)
        yield


@pytest.fixture(scope='module')
def fleet(open_graph, gear_path, transform_type):
    """Last messages of two ships, each with its own prefix, in one graph."""
    with open_graph() as graph:
        listener = graph.add(Listener)
        for ship, length in SHIPS.items():
            # As a file of parameters for all nodes has it: a node leaves unread what it lacks.
            given = {
                'frame_prefix': f'{ship}/', 'vessel_frame': 'base_link', 'odom_frame': 'odom',
                'gear': str(gear_path),
            }  # fmt: skip
            for kind in (WinchNode, DoorSensorNode, VesselNode):
                graph.add(partial(kind, namespace=ship), **given)
            instruments = ['winch_node', 'door_sensor_node', 'vessel_node']
            graph.add(
                partial(SimNode, namespace=ship),
                warp_length_m=length, speed_m_s=2.1, wait_for=instruments, **given,
            )  # fmt: skip
        graph.until(lambda: len(listener.last) == len(SHIPS) * len(HEARD))
        return SimpleNamespace(last=dict(listener.last), parents=dict(listener.parents))


def frames(message):
    if hasattr(message, 'markers'):
        return {marker.header.frame_id for marker in message.markers}
    return {message.header.frame_id}


@pytest.mark.parametrize('ship', SHIPS)
def test_frames_have_the_prefix_of_their_ship(fleet, ship):
    found = {topic: frames(fleet.last[ship, topic]) for topic in HEARD}
    assert found == {
        'truth/winch': {'map'},
        'truth/vessel/odom': {'map'},
        'truth/door/port/odom': {'map'},
        'truth/gear': {'map'},
        'winch/joint_states': {f'{ship}/base_link'},
        'vessel/heading': {f'{ship}/base_link'},
        'vessel/echo_sounder/depth': {f'{ship}/echo_sounder'},
        'door/spread': {f'{ship}/door_port_spread'},
    }
    assert fleet.last[ship, 'truth/vessel/odom'].child_frame_id == f'{ship}/base_link'
    assert fleet.last[ship, 'truth/door/port/odom'].child_frame_id == f'{ship}/door_port'


@pytest.mark.parametrize('ship', SHIPS)
def test_each_ship_hears_her_own_gear(fleet, ship):
    other = next(name for name in SHIPS if name != ship)
    own, theirs = SHIPS[ship], SHIPS[other]
    for topic in ('truth/winch', 'winch/joint_states'):
        for length in fleet.last[ship, topic].position:
            assert abs(length - own) < abs(length - theirs)


def test_transforms_of_both_ships_are_one_tree_from_map(fleet):
    own = {
        'odom': 'map',
        'base_link': 'odom',
        'sonar': 'map',
        'door_port': 'map',
        'door_starboard': 'map',
        'echo_sounder': 'base_link',
        'door_port_spread': 'door_port',
        'slant_range': 'base_link',
    }
    assert fleet.parents == {
        f'{ship}/{frame}': parent if parent == 'map' else f'{ship}/{parent}'
        for ship in SHIPS
        for frame, parent in own.items()
    }


def test_names_that_would_mix_are_refused(graph, gear_path):
    with pytest.raises(ParameterError, match='a name of its own'):
        graph.add(SimNode, gear=str(gear_path), vessel_frame='sonar')
    with pytest.raises(ParameterError, match='map_frame'):
        graph.add(SimNode, gear=str(gear_path), map_frame='')


def test_a_ship_is_where_her_position_and_heading_say():
    datum = Datum(60.0, 5.0)
    latitude, longitude = to_latitude_longitude([300.0, -40.0, 0.0], datum)
    pose = ShipPose(datum, odom=False)
    fix = FixSample(10 * SECOND, latitude, longitude, 1.0)
    assert pose.take(fix) is None
    assert pose.take(HeadingSample(9 * SECOND, math.pi / 2, 0.01)) is None
    topic, message = pose.take(fix)
    (ship,) = message.transforms
    assert (topic, ship.header.frame_id, ship.child_frame_id) == ('/tf', 'map', 'vessel')
    moved, turned = ship.transform.translation, ship.transform.rotation
    assert (moved.x, moved.y, moved.z) == pytest.approx((300.0, -40.0, 0.0), abs=1e-3)
    assert (turned.z, turned.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    # Of a heading that is long ago nobody knows which way she looks.
    assert pose.take(FixSample(60 * SECOND, latitude, longitude, 1.0)) is None


def test_a_link_of_a_real_ship_takes_names_of_frames_too(graph):
    node = graph.add(NmeaIn, links=['udp://:20251'], frame_prefix='ship/', vessel_frame='base_link')
    assert node.frame_names['vessel'] == 'ship/base_link'
    assert 'map' not in node.frame_names
