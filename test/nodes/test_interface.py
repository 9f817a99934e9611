"""docs/interface.md is what the code says, and what a running graph has."""

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from interface.page import CONVENTIONS, DOCUMENT, NODES, SECTIONS, node_class, page, specs

from trawl_ros.nodes.runtime.parameters import OWN_TO_ROS
from trawl_ros.nodes.runtime.qos import offered
from trawl_ros.records.rights import EVERY_NODE, NODE_RIGHTS
from trawl_ros.records.topics import TOPICS, absolute

pytestmark = pytest.mark.ros

ROWS = {topic.name: topic for topics in SECTIONS.values() for topic in topics}


@pytest.fixture(scope='module')
def nodes(open_graph, gear_path, tmp_path_factory):
    """All nodes that open no window, in one graph, by name."""
    gear = {'gear': str(gear_path)}
    given = {
        **dict.fromkeys(
            ('sim_node', 'trial_node', 'identification_node', 'discrepancy_node'), gear
        ),
        'bag_recorder': {'output': str(tmp_path_factory.mktemp('interface') / 'bag')},
        'bag_player': {'bag': 'bags/sea_trial', 'start_paused': True},
        'foxglove_node': {'port': 20244},
        'nmea_in': {'links': ['udp://:20245'], 'systems': ['ship', 'set_points'], 'commands': True},
        'nmea_out': {'links': ['udp://127.0.0.1:20246'], 'systems': ['ship']},
    }
    with open_graph() as graph:
        made = {name: graph.add(node_class(name), **given.get(name, {})) for name in NODES}
        graph.rest(1.0)
        yield made


def test_the_page_is_drawn_from_the_code():
    assert page() == DOCUMENT.read_text(encoding='utf-8')


def test_every_topic_type_and_node_is_on_it():
    assert ROWS.items() >= TOPICS.items()
    assert {topic.type for topic in ROWS.values()} == set(CONVENTIONS)
    assert set(NODES) == set(NODE_RIGHTS)


@pytest.mark.parametrize('name', NODES)
def test_a_node_has_the_parameters_of_its_table(nodes, name):
    node = nodes[name]
    declared = {name for name in node._parameters if not name.startswith(OWN_TO_ROS)}
    listed = {spec.name: spec for spec in specs(name)}
    assert declared == set(listed)
    for key, spec in listed.items():
        assert spec.sentence in node.describe_parameter(key).description


@pytest.mark.parametrize('name', NODES)
def test_a_node_publishes_with_the_type_and_qos_of_the_table(nodes, name):
    for topic, sender in nodes[name]._senders.items():
        # What a bag holds is played under its own names.
        if name == 'bag_player' and topic not in ROWS:
            continue
        kind, row = sender.msg_type, ROWS[topic]
        assert f'{kind.__module__.split(".")[0]}/msg/{kind.__name__}' == row.type
        assert sender.topic_name == absolute(topic)
        found, wanted = sender.qos_profile, offered(TOPICS.get(topic))
        assert (found.depth, found.durability, found.reliability) == (
            wanted.depth,
            wanted.durability,
            wanted.reliability,
        )


@pytest.mark.parametrize('name', NODES)
def test_a_node_offers_the_services_of_the_table(nodes, name):
    node = nodes[name]
    found = dict(node.get_service_names_and_types_by_node(name, '/trawl'))
    own = absolute(name)
    listed = {
        service.replace('~', own) if service[0] == '~' else absolute(service)
        for service in (*NODE_RIGHTS[name].answers, *EVERY_NODE.answers)
    }
    assert set(found) == listed
    for service in NODE_RIGHTS[name].answers:
        full = service.replace('~', own) if service[0] == '~' else absolute(service)
        assert found[full] == ['std_srvs/srv/Trigger']
