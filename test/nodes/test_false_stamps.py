"""Stamps that cannot be: the recorder takes the time of receipt, the player says that it waits."""

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.bags.check import check_bag  # noqa: E402
from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.diagnostics import WARN  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.bag_player import BagPlayer  # noqa: E402
from trawl_ros.nodes.bag_recorder import BagRecorder  # noqa: E402
from trawl_ros.nodes.identification_node import IdentificationNode  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

pytestmark = pytest.mark.ros

START = 1_785_000_000 * SECOND
HEADING = 'vessel/heading'


def heading(stamp):
    return sample_message(HeadingSample(stamp, 0.5, 0.1))[1]


def test_a_bag_of_the_project_s_own_nodes_spans_what_was_recorded(graph, tmp_path):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'))
    graph.add(IdentificationNode)
    graph.until(lambda: '/trawl/identification/status' in recorder._bag.counts)
    graph.remove(recorder)
    check = check_bag(tmp_path / 'bag')
    assert check.end - check.start < 60 * SECOND
    assert 'stamp' not in {finding.kind for finding in check.findings}


def test_a_driver_that_never_stamps_is_recorded_as_it_was_received_and_counted(graph, tmp_path):
    recorder = graph.add(BagRecorder, output=str(tmp_path / 'bag'), topics=[HEADING])
    driver = graph.add(lambda **given: TrawlNode('driver', **given))
    driver.advertise(HEADING)
    graph.until(lambda: all(matched for matched, _ in driver.subscribers().values()))
    began = recorder.now()
    for stamp in (0, 0, driver.now(), 0, 315_964_800 * SECOND):
        driver.send(HEADING, heading(stamp))
    graph.until(lambda: sum(recorder._bag.counts.values()) == 5)
    (status,) = recorder.statuses()
    assert status.level == WARN
    assert status.message.startswith('4 messages ')
    graph.remove(recorder)
    times = [message.log_time for message in Bag(tmp_path / 'bag').raw()]
    assert began - SECOND < min(times) <= max(times) < began + 60 * SECOND


@pytest.mark.parametrize('pause', [3600 * SECOND, 21 * 365 * 86_400 * SECOND])
def test_the_player_says_that_the_next_message_is_far_off(graph, tmp_path, pause):
    with BagWriter(tmp_path / 'bag') as bag:
        for stamp in (START, START + SECOND // 10, START + pause):
            message = heading(START)
            bag.write(absolute(HEADING), message.__msgtype__, serialize(message), stamp)
    player = graph.add(BagPlayer, bag=str(tmp_path / 'bag'))
    graph.until(lambda: player.statuses()[0].level == WARN)
    assert player.statuses()[0].message.startswith('the next message ')
