"""A recorder killed in the middle leaves a bag that lacks a second at most, and can be repaired."""

import os
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

import yaml  # noqa: E402
from rosbags.rosbag2 import Reader  # noqa: E402

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.bags.repair import repair_bag  # noqa: E402
from trawl_ros.bags.storage.mcap_file import McapFile  # noqa: E402
from trawl_ros.bags.storage.metadata_faults import lacking  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.records.samples import HeadingSample  # noqa: E402

pytestmark = pytest.mark.ros

TOPIC = '/trawl/vessel/heading'
RUN_S = 2.7
"""Not a multiple of the recorder's own period."""


class Gyro(TrawlNode):
    """Says a hundred times a second when it is."""

    def __init__(self, **kwargs):
        super().__init__('gyro', **kwargs)
        self.stamps = []
        self.advertise('vessel/heading')
        self.every(0.01, self._say)

    def _say(self):
        if self.subscribers()['vessel/heading'][0]:
            self.stamps.append(time.time_ns())
            self.send('vessel/heading', sample_message(HeadingSample(self.stamps[-1], 1.0, 0.1))[1])


@pytest.fixture(scope='module')
def killed(open_graph, tmp_path_factory):
    folder = tmp_path_factory.mktemp('killed')
    path = folder / 'bag'
    code = 'import sys; from trawl_ros.nodes.bag_recorder import main; sys.exit(main())'
    with (
        open_graph() as graph,
        subprocess.Popen(
            [sys.executable, '-c', code, '--ros-args', '-p', f'output:={path}'],
            env={**os.environ, **graph.environment},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        ) as recorder,
    ):
        gyro = graph.add(Gyro)
        graph.until(lambda: gyro.stamps)
        graph.rest(RUN_S)
        at = time.time_ns()
        recorder.send_signal(signal.SIGKILL)
        recorder.wait()
    return SimpleNamespace(path=path, at=at, published=gyro.stamps)


def recorded(path):
    return [message.log_time for message in Bag(path).raw({TOPIC})]


def test_it_is_readable_up_to_less_than_a_second_before(killed):
    found = recorded(killed.path)
    assert found == killed.published[: len(found)]
    assert 0 <= killed.at - found[-1] < SECOND
    assert len(found) > 100 * (RUN_S - 1.0) * 0.5


def test_its_metadata_are_whole(killed):
    data = yaml.safe_load((killed.path / 'metadata.yaml').read_text())
    information = data['rosbag2_bagfile_information']
    assert lacking(information) == []
    assert information['message_count'] <= sum(1 for _ in Bag(killed.path).raw())


def test_repaired_it_has_all_that_with_index_and_metadata(killed, tmp_path):
    done = repair_bag(killed.path, tmp_path / 'whole')
    assert done.lost == {}
    assert recorded(done.out) == recorded(killed.path)
    with Reader(done.out) as reader:
        headings = [c for c in reader.connections if c.topic == TOPIC]
        assert [stamp for _, stamp, _ in reader.messages(headings)] == recorded(killed.path)
    file = McapFile(done.out / 'whole_0.mcap', pytest.fail)
    assert (file.complete, file.indexed) == (True, True)
