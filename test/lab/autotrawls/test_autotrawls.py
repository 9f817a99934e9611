"""The bench tows the same scenario with every controller, whether a class or a node."""

import json
import math
import sys

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.autotrawls.controllers import ForeignController, load_class, shipped
from trawl_ros.lab.autotrawls.tows import (
    SCENARIOS,
    SCORED_FROM_S,
    TowHistory,
    bench_scenario,
    score,
    tow_with,
)
from trawl_ros.lab.commands.bench import write_bench
from trawl_ros.records.samples import WinchSample
from trawl_ros.scenario.scenario import load_scenario

SHORT = """\
description: twelve seconds in which warp is hauled
gear: coarse.yaml
start: {warp_length_m: 300.0, speed_m_s: 2.2}
instruments: {winch: {rate_hz: 2.0}}
steps:
  - {name: hold, minutes: 0.1, autotrawl: {mode: tension}}
  - {name: haul, minutes: 0.1, warp_length_m: 298.0}
truth_rate_hz: 2.0
"""

NODE = """\
import sys
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState

rclpy.init(args=sys.argv)
node = Node('mine')
out = node.create_publisher(JointState, 'command/winch', 10)

def take(reading):
    command = JointState(name=list(reading.name), position=[301.0, 299.0])
    command.header.stamp = reading.header.stamp
    out.publish(command)

node.create_subscription(JointState, 'winch/joint_states', take, 10)
rclpy.spin(node)
"""


class Mine:
    """Pays out on port; its starboard winch is left alone."""

    def __init__(self, lengths):
        self.lengths = lengths
        self.heard = []

    def set_lengths(self, port, starboard):
        self.lengths = (port, starboard)

    def update(self, sample):
        self.heard.append(sample.stamp)
        return self.lengths[0] + 1.0, math.nan


@pytest.fixture
def short(tmp_path, coarse_gear):
    (tmp_path / 'coarse.yaml').write_bytes(coarse_gear.read_bytes())
    path = tmp_path / 'short.yaml'
    path.write_text(SHORT)
    return load_scenario(path)


def history(port, starboard, spread=100.0, speed=0.0):
    """Tow of two minutes with these values, the first of which is not scored."""
    times = np.arange(0.0, 2 * SCORED_FROM_S, 0.5)
    shape = (len(times), 2)
    return TowHistory(
        times, np.broadcast_to((port, starboard), shape), 300.0 + speed * np.outer(times, (1, 1)),
        np.full(len(times), spread), np.full(len(times), 100.0),
    )  # fmt: skip


def test_scores_are_those_of_their_definitions():
    found = score(history(6e4, 4e4, spread=103.0, speed=-0.2))
    assert found.imbalance == pytest.approx(20.0)
    assert found.tension_std == 0.0
    assert found.spread_error == pytest.approx(3.0)
    assert found.wire_speed == pytest.approx(0.2)
    even = history(5e4, 5e4)
    assert score(even).imbalance == score(even).spread_error == 0.0


@pytest.mark.parametrize('name', SCENARIOS)
def test_each_scenario_begins_with_an_autotrawl_and_is_scored_for_minutes(name):
    scenario = bench_scenario(name)
    assert scenario.autotrawled
    assert scenario.steered
    assert scenario.duration_s > SCORED_FROM_S + 240.0
    assert len(scenario.effect_set.effects) == len(scenario.record.effects)


def test_a_class_works_the_winches(short):
    made = []

    def make(lengths):
        made.append(Mine(lengths))
        return ForeignController(made[-1], lengths)

    tow = tow_with(short, make)
    assert made[0].lengths == (298.0, 298.0)
    assert len(made[0].heard) == 24
    port, starboard = tow.lengths[-1]
    assert port < starboard - 0.2
    assert tow.lengths[0] == pytest.approx([300.0, 300.0])
    assert tow.wanted_spreads[0] > tow.wanted_spreads[-1]


def test_a_report_has_the_scores_of_all(tmp_path, short):
    make = shipped(short.plant.winch)
    assert set(make) == {'standing', 'lengths', 'tension'}
    write_bench(tmp_path / 'out', {'swell': {'one': history(5e4, 5e4), 'two': history(6e4, 4e4)}})
    record = json.loads((tmp_path / 'out' / 'autotrawl.json').read_text())
    assert record['swell']['two']['imbalance'] == pytest.approx(20.0)
    page = (tmp_path / 'out' / 'autotrawl.md').read_text()
    assert '| two | 20 |' in page
    assert (tmp_path / 'out' / 'swell.png').is_file()


@pytest.mark.parametrize('found', [3.0, (1.0,), 'ab', None])
def test_what_is_no_pair_of_lengths_is_said(found):
    mine = Mine((300.0, 300.0))
    mine.update = lambda sample: found
    sample = WinchSample(0, (300.0, 300.0), (0.0, 0.0), (5e4, 5e4))
    with pytest.raises(TrawlError, match='expected the wanted lengths'):
        ForeignController(mine, (300.0, 300.0)).update(sample)


@pytest.mark.parametrize('name', ['nothing:Here', 'math:pi', 'math', 'nowhere'])
def test_a_class_that_is_none_is_said(name):
    with pytest.raises(TrawlError, match=r'module:Class|no method update'):
        load_class(name)


@pytest.mark.ros
def test_a_node_works_the_winches(short, tmp_path):
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    from trawl_ros.lab.autotrawls.node_controller import node_controller

    (tmp_path / 'mine.py').write_text(NODE)
    with node_controller(f'{sys.executable} {tmp_path / "mine.py"}', tmp_path / 'logs') as make:
        tow = tow_with(short, make)
    port, starboard = tow.lengths[-1]
    assert port > 300.2
    assert starboard < 299.8


@pytest.mark.ros
def test_a_node_that_ends_is_said_with_its_last_line(tmp_path):
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    from trawl_ros.lab.autotrawls.node_controller import node_controller

    command = f'{sys.executable} -c "raise SystemExit(\'no such winch\')"'
    with (
        pytest.raises(TrawlError, match='no such winch'),
        node_controller(command, tmp_path / 'logs'),
    ):
        pass
