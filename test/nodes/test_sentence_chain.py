"""Instruments through sentences, over two lines at once: rounding explains the estimate."""

import math
import socket
import sys

import numpy as np
import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.samples import SampleStream  # noqa: E402
from trawl_ros.core.network import THIS_MACHINE  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.estimation.from_gear import identification_for  # noqa: E402
from trawl_ros.estimation.pipeline import WindowUsed  # noqa: E402
from trawl_ros.estimation.windows.records import WindowOptions  # noqa: E402
from trawl_ros.gear.load import load_gear  # noqa: E402
from trawl_ros.messages.from_messages import to_sample  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.door_sensor_node import DoorSensorNode  # noqa: E402
from trawl_ros.nodes.identification_node import SAMPLES, IdentificationNode  # noqa: E402
from trawl_ros.nodes.nmea_in import NmeaIn  # noqa: E402
from trawl_ros.nodes.nmea_out import NmeaOut  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402
from trawl_ros.nodes.sim_node import SimNode  # noqa: E402
from trawl_ros.nodes.trawl_sonar_node import TrawlSonarNode  # noqa: E402
from trawl_ros.nodes.vessel_node import VesselNode  # noqa: E402
from trawl_ros.nodes.winch_node import WinchNode  # noqa: E402
from trawl_ros.records.fields import WaterColumn, fields_of_sample, sample_of_fields  # noqa: E402
from trawl_ros.sentences.table import load_table  # noqa: E402

pytestmark = pytest.mark.ros

START = 1000 * SECOND
LEG_S = 40
RULES = {'settle_s': 10.0, 'settle_passages': 0.0, 'window_s': 20.0}
WATER = WaterColumn(density_kg_m3=1025.0)
GEAR_SYSTEMS, SHIP_SYSTEMS = ['marport'], ['scantrol', 'ship']
FIELDS = {
    field.target: (field, table)
    for table in map(load_table, (*GEAR_SYSTEMS, *SHIP_SYSTEMS))
    for row in table.sentences.values()
    for field in row.fields
    if field.reading and not row.form
}
"""What these systems tell, by topic and field."""


@pytest.fixture(scope='module')
def bag(steady_samples, steady_tow, tmp_path_factory):
    return steady_tow.write(tmp_path_factory.mktemp('steady') / 'bag', steady_samples(START, LEG_S))


def offline(gear, samples, rules):
    """The estimates after each window."""
    identification = identification_for(load_gear(gear), window_options=WindowOptions(**rules))
    events = [event for sample in samples for event in identification.feed(sample)]
    return [event.estimate for event in events if isinstance(event, WindowUsed)]


def as_told(sample, *, rounded):
    """A sample as the systems tell it: with the noise that their tables state, rounded or not."""
    topic, fields = fields_of_sample(sample, WATER) or ('', {})
    told = {name: value for name, value in fields.items() if (topic, name) in FIELDS}
    if not told:
        return None
    if rounded:
        told = {name: to_its_step(value, topic, name) for name, value in told.items()}
    stated = FIELDS[topic, next(iter(told))][1].stated(topic, WATER)
    return sample_of_fields(topic, sample.stamp, told, stated, WATER)


def to_its_step(value, topic, name):
    field, _ = FIELDS[topic, name]
    step = field.step
    return value if math.isnan(value) else round(value / step) * step


def renamed(name, **remaps):
    words = [word for key, value in remaps.items() for word in ('-r', f'{key}:={value}')]
    return ['--ros-args', '-r', f'__node:={name}', *words]


@pytest.fixture
def links(tmp_path):
    """A pseudo-terminal, as its maker and its user name it, and a UDP port."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind((THIS_MACHINE, 0))
        port = probe.getsockname()[1]
    tty = tmp_path / 'tty'
    return f'pty:{tty}', f'serial:{tty}', f'udp://:{port}'


TAGGED, CLOCKED = {'tag_blocks': True}, {'clock_interval_s': 1.0}


@pytest.fixture
def rules():
    """Criteria of a steady window."""
    return RULES


@pytest.fixture(params=[TAGGED])
def aboard(request, graph, links, estimate_listener, coarse_gear, rules):
    """Speakers in `trawl`; a listener to sentences and an estimator of its own in `aboard`."""
    pty, serial, udp = links
    for name, link, systems in (
        ('gear_out', pty, GEAR_SYSTEMS),
        ('ship_out', udp, SHIP_SYSTEMS),
    ):
        graph.add(
            lambda name=name, **given: NmeaOut(cli_args=renamed(name), **given),
            links=[link], systems=systems, every_reading=True, **request.param,
        )  # fmt: skip
    hearing = graph.add(
        lambda **given: NmeaIn(namespace='aboard', **given),
        links=[serial, udp], systems=[*GEAR_SYSTEMS, *SHIP_SYSTEMS], time='sentences',
    )  # fmt: skip
    listener = graph.add(lambda **given: estimate_listener(namespace='aboard', **given))
    # The source waits for what is estimated at the other end of the lines.
    remaps = renamed('aboard_node', **{'sync/progress': '/trawl/sync/progress'})
    node = graph.add(
        lambda **given: IdentificationNode(namespace='aboard', cli_args=remaps, **given),
        gear=str(coarse_gear), advise=False, **rules,
    )  # fmt: skip
    graph.until(lambda: all(source.state == '' for source in hearing._line_sources))
    yield hearing, listener, node
    node._worker.reset()


def compare(aboard, samples, gear, rules):
    """Hold what was estimated behind the lines against the topics' own samples.

    It is to be what rounding makes of these, and nothing else: the readings rounded to the steps
    of the tables and no more, with the noise that the tables state, give the same estimate.

    Gives the largest differences from that, and what rounding alone does, in standard deviations.
    """
    hearing, listener, _ = aboard
    assert [source.lost for source in hearing._line_sources] == [0, 0]
    assert hearing._tally.refused == hearing._tally.foreign == 0
    exact, rounded = (
        offline(gear, [told for one in samples if (told := as_told(one, rounded=rounded))], rules)
        for rounded in (False, True)
    )
    assert len(listener.estimates) == len(exact) == len(rounded) > 1
    told = zip(listener.estimates, exact, rounded, strict=True)
    return np.max([(off(values, two), off(two.values, one)) for values, one, two in told], axis=0)


def off(values, estimate):
    """Largest difference of a coefficient, in standard deviations of what is known of it."""
    return np.max(np.abs(values - estimate.values) / estimate.std)


@pytest.mark.parametrize(
    ('aboard', 'bound'),
    [
        # A distance is a number of 32 bits in its message.
        (TAGGED, 1e-4),
        # Many times as fast as the wall, where a clock between the readings says little.
        pytest.param(CLOCKED, 0.01, marks=pytest.mark.slow),
    ],
    indirect=['aboard'],
    ids=['tag blocks', 'clock'],
)
def test_a_bag_through_two_lines_gives_what_rounding_makes_of_it(
    graph, aboard, bound, bag, coarse_gear
):
    _, listener, node = aboard
    graph.add(BagPlayer, bag=str(bag), rate=0.0, wait_for=[node.get_name()])
    graph.until(lambda: len(listener.estimates) == 2, timeout_s=120.0)
    graph.settle(0.2)
    samples = [sample for _, sample in SampleStream([bag], 'trawl')]
    unexplained, by_rounding = compare(aboard, samples, coarse_gear, RULES)
    assert unexplained < bound
    assert 1e-4 < by_rounding < 0.03


class Keeper(TrawlNode):
    """Listener that keeps what the instruments say."""

    def __init__(self, **kwargs):
        super().__init__('keeper', **kwargs)
        self.samples = []
        for topic in SAMPLES:
            self.listen(topic, self._keeping(topic), CONSUMER)

    def _keeping(self, topic):
        return lambda message: self.samples.append(to_sample(topic, message))


SCENARIO = """\
description: Two states and the veering between them
gear: {gear}
seed: 23
start: {{warp_length_m: 300.0, speed_m_s: 2.2}}
steps:
  - {{name: hold, minutes: 5.0}}
  - {{name: veer, minutes: 6.5, warp_length_m: 330.0}}
truth_rate_hz: 2.0
record: [instruments]
"""
INSTRUMENTS = WinchNode, DoorSensorNode, TrawlSonarNode, VesselNode


# The doors settle for four minutes after the veering. A window on their way is at the limit of the
# drift, where the noise that a table states decides whether it is used.
@pytest.mark.slow
@pytest.mark.parametrize('rules', [{**RULES, 'settle_s': 240.0}], ids=['settled'])
def test_the_simulation_through_two_lines_gives_the_estimate_of_its_topics(
    graph, aboard, estimate_listener, coarse_gear, rules, tmp_path
):
    node = aboard[-1]
    scenario = tmp_path / 'two.yaml'
    scenario.write_text(SCENARIO.format(gear=coarse_gear))
    # Nor does it hear what no sentence tells.
    told = {topic for topic, _ in FIELDS}
    deaf = renamed('beside_node', **{topic: f'untold/{topic}' for topic in {*SAMPLES} - told})
    beside = graph.add(
        lambda **given: IdentificationNode(cli_args=deaf, **given),
        gear=str(coarse_gear), advise=False, **rules,
    )  # fmt: skip
    ashore, keeper = graph.add(estimate_listener), graph.add(Keeper)
    nodes = [graph.add(kind, scenario=str(scenario)) for kind in INSTRUMENTS]
    waited_for = [one.get_name() for one in (*nodes, beside, node)]
    sim = graph.add(
        SimNode, scenario=str(scenario), time_scale=0.0, wait_for=waited_for, exit_at_end=True
    )
    graph.until(lambda: sim.exit_code is not None, timeout_s=900.0)
    graph.until(lambda: node._worker.idle and beside._worker.idle)
    graph.settle(0.5)
    beside._worker.reset()
    unexplained, by_rounding = compare(aboard, keeper.samples, coarse_gear, rules)
    assert unexplained < 1e-4
    assert by_rounding < 0.03
    # Beside rounding it is the noise that tables state, and sentences cannot.
    live = zip(aboard[1].estimates, ashore.estimates, ashore.covariances, strict=True)
    apart = max(
        np.max(np.abs(values - alone) / np.sqrt(np.diag(np.reshape(covariance, (12, 12)))))
        for values, alone, covariance in live
    )
    assert apart < 0.1
    sys.stdout.write(
        f'\n{sim._tow.time_s:.0f} s towed, {len(ashore.estimates)} windows; estimates are '
        f'{apart:.4f} standard deviations apart, by rounding {by_rounding:.4f}, '
        f'unexplained {unexplained:.1e}\n'
    )
