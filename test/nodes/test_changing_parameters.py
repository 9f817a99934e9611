"""Every parameter of every node changes at run time, or says why it does not."""

import inspect
from importlib import import_module
from pkgutil import iter_modules

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rclpy.parameter import Parameter  # noqa: E402

import trawl_ros.nodes  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.parameters import FIXED, OWN_TO_ROS, Number, Text, misspelt  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

pytestmark = pytest.mark.ros


def executables():
    """The class of each node that has a command of its own."""
    for found in iter_modules(trawl_ros.nodes.__path__):
        module = import_module(f'trawl_ros.nodes.{found.name}')
        if hasattr(module, 'main'):
            own = [kind for _, kind in inspect.getmembers(module, inspect.isclass)]
            yield from (
                kind
                for kind in own
                if kind.__module__ == module.__name__ and issubclass(kind, TrawlNode)
            )


@pytest.fixture(scope='module')
def bag(tmp_path_factory):
    """Ten minutes of a compass."""
    path = tmp_path_factory.mktemp('bag') / 'bag'
    with BagWriter(path) as writer:
        for second in range(600):
            topic, message = sample_message(HeadingSample(second * SECOND, 0.1, 0.01))
            writer.write(absolute(topic), message.__msgtype__, serialize(message), second * SECOND)
    return path


@pytest.fixture(scope='module')
def graph(open_graph):
    with open_graph() as graph:
        yield graph


@pytest.fixture
def add(graph, bag, gear_path, tmp_path):
    """Add a node with what it cannot do without, and take it out again."""
    added = []

    def add_node(kind, **parameters):
        names = {spec.name for spec in kind.SPECS}
        needed = {'gear': str(gear_path)} if 'gear' in names else {}
        if kind is BagPlayer:
            needed = {'bag': str(bag)}
        elif 'output' in names:
            needed['output'] = str(tmp_path / 'output')
        added.append(graph.add(kind, **{**needed, **parameters}))
        return added[-1]

    yield add_node
    for node in added:
        graph.remove(node)


def another_value(node, name):
    """A value of the right kind that a parameter does not have now."""
    present = node.get_parameter(name).value
    spec = next((spec for spec in node.SPECS if spec.name == name), None)
    if isinstance(present, bool):
        return not present
    if isinstance(spec, Number):
        inside = [spec.low + share * (spec.high - spec.low) for share in (0.4, 0.6)]
        values = [round(value) if spec.whole else value for value in inside]
        return next(value for value in values if value != present)
    if isinstance(present, (int, float)):
        return present + 1
    if isinstance(spec, Text) and spec.choices:
        return next(choice for choice in spec.choices if choice != present)
    return 'another'


@pytest.mark.parametrize('kind', list(executables()), ids=lambda kind: kind.__name__)
def test_every_parameter_changes_or_says_why_not(add, kind):
    node = add(kind)
    live = {spec.name for spec in node.SPECS if spec.live}
    names = [name for name in node._parameters if not name.startswith(OWN_TO_ROS)]
    assert {spec.name for spec in node.SPECS} <= set(names)
    for name in names:
        before, wanted = node.get_parameter(name).value, another_value(node, name)
        (answer,) = node.set_parameters([Parameter(name, value=wanted)])
        description = node.describe_parameter(name)
        assert description.description
        if name in live:
            assert answer.successful or f'{name}: found' in answer.reason
            assert not description.additional_constraints
        else:
            assert not answer.successful, name
            assert answer.reason == f'{name}: {FIXED}'
            assert description.additional_constraints == FIXED
        held = wanted if answer.successful else before
        assert node.get_parameter(name).value == held
        if answer.successful:
            assert node.parameters[name] == held


def test_a_name_that_no_parameter_has_is_told_with_the_nearest(add):
    node = add(SimNode, sped_m_s=2.0, whatever=1)
    first, second = misspelt(node)
    assert first.startswith('parameter sped_m_s: ')
    assert first.endswith('expected speed_m_s')
    assert second.startswith('parameter whatever: ')
    assert not misspelt(add(SimNode, speed_m_s=2.0, use_sim_time=False))


def test_what_is_as_it_was_is_no_change(add):
    node = add(SimNode)
    (answer,) = node.set_parameters([Parameter('speed_m_s', value=2)])
    assert answer.successful, answer.reason


class Listener(TrawlNode):
    """Counts what comes on a topic."""

    def __init__(self, **kwargs):
        super().__init__('listener', **kwargs)
        self.heard = []
        self.listen('truth/gear', self.heard.append, CONSUMER)
        self.listen('vessel/heading', self.heard.append, CONSUMER)


def pace(graph, data_time):
    """Data seconds per wall second over half a second."""
    before = data_time()
    graph.rest(0.5)
    return (data_time() - before) / 0.5


def test_the_time_scale_changes_on_the_way(graph, add):
    node = add(SimNode, warp_length_m=300, speed_m_s=2.1, publish_clock=True, time_scale=1.0)
    graph.until(lambda: node._tow.time_s > 0.2)
    assert pace(graph, lambda: node._tow.time_s) < 1.6
    (answer,) = node.set_parameters([Parameter('time_scale', value=4)])
    assert answer.successful, answer.reason
    # A busy machine may be slow for a while.
    graph.until(lambda: pace(graph, lambda: node._tow.time_s) > 2.5)


def test_the_rate_of_the_picture_changes_on_the_way(graph, add):
    node = add(SimNode, warp_length_m=300, speed_m_s=2.1, gear_rate_hz=0.0, time_scale=4.0)
    listener = add(Listener)
    graph.until(lambda: node._tow.time_s > 3.0)
    assert not listener.heard
    node.set_parameters([Parameter('gear_rate_hz', value=1.0)])
    graph.until(lambda: listener.heard)


def test_the_rate_of_the_player_changes_on_the_way(graph, add):
    node = add(BagPlayer, publish_clock=True, rate=1.0)
    graph.until(lambda: node._latest >= SECOND)
    node.set_parameters([Parameter('rate', value=50.0)])
    graph.until(lambda: pace(graph, lambda: node._latest / SECOND) > 25.0)


def test_the_player_learns_to_loop_on_the_way(graph, add):
    node = add(BagPlayer, rate=1000.0, start=590.0)
    node.set_parameters([Parameter('loop', value=True)])
    graph.until(lambda: node._rounds > 1)
    node.set_parameters([Parameter('loop', value=False)])
    graph.until(lambda: node.exit_code == 0)
