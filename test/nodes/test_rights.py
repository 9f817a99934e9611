"""Every node uses what its rights allow, and no more."""

import json

import pytest
from websockets.sync.client import connect

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.nodes.autopilot_node import AutopilotNode  # noqa: E402
from trawl_ros.nodes.autotrawl_node import AutotrawlNode  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.discrepancy_node import DiscrepancyNode  # noqa: E402
from trawl_ros.nodes.door_sensor_node import DoorSensorNode  # noqa: E402
from trawl_ros.nodes.foxglove_node import FoxgloveNode  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.nmea_in import NmeaIn  # noqa: E402
from trawl_ros.nodes.nmea_out import NmeaOut  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.tether_node import TetherNode  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.nodes.trial_node import TrialNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.view_node import ViewNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.rights import EVERY_NODE, OPERATOR, SET_POINTS, enclaves  # noqa: E402
from trawl_ros.records.topics import CLOCK, STATIC_TRANSFORMS, TRANSFORMS, absolute  # noqa: E402
from trawl_ros.records.truth import SIDES  # noqa: E402

pytestmark = pytest.mark.ros

NODES = (
    AutopilotNode,
    AutotrawlNode,
    BagPlayer,
    BagRecorder,
    DiscrepancyNode,
    DoorSensorNode,
    FoxgloveNode,
    IdentificationNode,
    NmeaIn,
    NmeaOut,
    SimNode,
    TetherNode,
    TrawlSonarNode,
    TrialNode,
    VesselNode,
    ViewNode,
    WinchNode,
)
VIEWED = 20234
SPOKEN = ['marport', 'scantrol', 'ship']
NODE_RIGHTS = {name: own for name, own in enclaves().items() if name != OPERATOR}
AT_TIMES = {
    '/parameter_events',
    '/rosout',
    CLOCK.name,
    TRANSFORMS.name,
    STATIC_TRANSFORMS.name,
    *(absolute(f'door/{side}/slant_range') for side in SIDES),
}
"""Topics of ROS itself, and those that depend on parameters or on what is installed."""


@pytest.fixture(scope='module')
def used(open_graph, gear_path, tmp_path_factory):
    """Names of what each node publishes, hears, answers and calls while all of them are there."""
    with open_graph() as graph:
        gear = {'gear': str(gear_path)}
        parameters = {
            'SimNode': gear,
            'IdentificationNode': gear,
            'DiscrepancyNode': gear,
            'TrialNode': gear,
            'TetherNode': gear,
            'BagRecorder': {'output': str(tmp_path_factory.mktemp('rights') / 'bag')},
            'FoxgloveNode': {'port': VIEWED},
            'NmeaIn': {'links': ['udp://:20232'], 'systems': SPOKEN},
            'BagPlayer': {'bag': 'bags/sea_trial', 'start_paused': True},
        }
        nodes = [graph.add(kind, **parameters.get(kind.__name__, {})) for kind in NODES]
        renamed = ['--ros-args', '-r', f'__node:={SET_POINTS}']
        commanding = graph.add(
            lambda **given: NmeaIn(cli_args=renamed, **given),
            links=['udp://:20233'], systems=[*SPOKEN, 'set_points'], commands=True,
        )  # fmt: skip
        recorder = nodes[NODES.index(BagRecorder)]
        shown = nodes[NODES.index(FoxgloveNode)]
        with connect(f'ws://127.0.0.1:{VIEWED}', subprotocols=['foxglove.sdk.v1']) as viewer:
            want_everything(viewer, len(shown._topics))
            graph.until(lambda: len(shown._heard) == len(shown._topics))
            graph.until(lambda: '/trawl/truth/winch' in recorder.traffic.counts('received'))
            graph.rest(1.0)
            return {node.get_name(): names_of(node) for node in (*nodes, commanding)}


def want_everything(viewer, topics):
    """Subscribe to all that is offered, for a topic is listened to only while it is wanted."""
    offered = []
    while len(offered) < topics:
        said = json.loads(viewer.recv(timeout=20.0))
        offered += [channel['id'] for channel in said.get('channels', ())]
    wishes = [{'id': number, 'channelId': channel} for number, channel in enumerate(offered)]
    viewer.send(json.dumps({'op': 'subscribe', 'subscriptions': wishes}))


def names_of(node):
    ways = ('publisher', 'subscriber', 'service', 'client')
    return [
        {
            name
            for name, _ in getattr(node, f'get_{way}_names_and_types_by_node')(
                node.get_name(), node.get_namespace()
            )
        }
        for way in ways
    ]


def full(names, node):
    own = absolute(node)
    return {name.replace('~', own) if name[0] == '~' else absolute(name) for name in names}


def test_all_nodes_are_looked_at(used):
    assert set(used) == set(NODE_RIGHTS)


@pytest.mark.parametrize('node', NODE_RIGHTS)
def test_a_node_uses_what_its_rights_allow(used, node):
    rights = NODE_RIGHTS[node]
    published, heard, answered, called = used[node]
    allowed = full((*EVERY_NODE.publishes, *rights.publishes), node)
    hearable = full((*EVERY_NODE.hears, *rights.hears), node)
    assert published <= allowed
    assert heard <= hearable
    assert answered == full((*EVERY_NODE.answers, *rights.answers), node)
    assert called == full(rights.calls, node)
    # No right is idle, but those on which a player depends on its bag, and all on their use.
    if node != 'bag_player':
        assert allowed - published <= AT_TIMES
        assert hearable - heard <= AT_TIMES
