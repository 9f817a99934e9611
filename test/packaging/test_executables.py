"""Every installed node starts, says how it is, and ends cleanly when it is told to."""

import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from diagnostic_msgs.msg import DiagnosticArray  # noqa: E402
from rclpy.context import Context  # noqa: E402
from rclpy.executors import SingleThreadedExecutor  # noqa: E402

from trawl_ros.bags.writer import BagWriter  # noqa: E402
from trawl_ros.core.time import SECOND  # noqa: E402
from trawl_ros.messages.cdr import serialize  # noqa: E402
from trawl_ros.messages.to_messages import sample_message  # noqa: E402
from trawl_ros.records.samples import HeadingSample  # noqa: E402
from trawl_ros.records.topics import absolute  # noqa: E402

NODES = (
    'sim_node',
    'winch_node',
    'door_sensor_node',
    'trawl_sonar_node',
    'vessel_node',
    'autotrawl_node',
    'autopilot_node',
    'trial_node',
    'identification_node',
    'bag_recorder',
    'bag_player',
    'discrepancy_node',
    'nmea_in',
    'nmea_out',
    'foxglove_node',
    'view_node',
    'tether_node',
)
# What is installed elsewhere is compiled anew there, which takes sim_node a quarter of a minute.
QUICK = ('vessel_node', 'winch_node')
START_S = 60.0  # the bound for a machine busy with other tests; one to three seconds are usual
END_S = 20.0

pytestmark = pytest.mark.ros


def small_bag(path: Path) -> Path:
    """A bag that takes a minute to play, longer than any node is looked at here."""
    with BagWriter(path) as bag:
        for second in range(60):
            topic, message = sample_message(HeadingSample(second * SECOND, 0.1, 0.01))
            bag.write(absolute(topic), message.__msgtype__, serialize(message), second * SECOND)
    return path


def parameters(node: str, scratch: Path) -> list[str]:
    """What a node cannot do without; all else has a default."""
    needed: dict[str, str] = {}
    if node == 'bag_player':
        needed['bag'] = str(small_bag(scratch / 'played'))
    if node == 'view_node':
        pytest.importorskip('rerun', reason='needs the extra `view`: make test-view installs it')
        needed['output'] = str(scratch / 'live.rrd')
    if node == 'bag_recorder':
        needed['output'] = str(scratch / 'recorded')
    options = [option for key, value in needed.items() for option in ('-p', f'{key}:={value}')]
    return ['--ros-args', *options] if options else []


@contextmanager
def diagnostics() -> Iterator[tuple[SingleThreadedExecutor, list[DiagnosticArray]]]:
    """Collect what is published on /diagnostics while the executor spins."""
    context = Context()
    rclpy.init(context=context)
    listener = rclpy.create_node('listener', context=context)
    received: list[DiagnosticArray] = []
    listener.create_subscription(DiagnosticArray, '/diagnostics', received.append, 10)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(listener)
    try:
        yield executor, received
    finally:
        executor.shutdown()
        listener.destroy_node()
        context.try_shutdown()


# All nodes end in one way of the same code, so each signal is tried on half of them.
@pytest.mark.parametrize(
    ('node', 'end'),
    [
        pytest.param(*case, marks=() if case[0] in QUICK else pytest.mark.slow)
        for case in zip(NODES, cycle((signal.SIGINT, signal.SIGTERM)))
    ],
)
def test_starts_publishes_and_ends_cleanly(workspace, node, end, tmp_path):
    environment = {**workspace.environment, 'ROS_LOG_DIR': str(tmp_path / 'log')}
    command = [str(workspace.executables / node), *parameters(node, tmp_path)]
    output = tmp_path / 'output.txt'
    with diagnostics() as (executor, received), output.open('w') as sink:
        process = subprocess.Popen(
            command,
            env=environment,
            cwd=tmp_path,
            stdin=subprocess.DEVNULL,
            stdout=sink,
            stderr=subprocess.STDOUT,
        )
        try:
            deadline = time.monotonic() + START_S
            while len(received) < 2 and process.poll() is None and time.monotonic() < deadline:
                executor.spin_once(timeout_sec=0.1)
            assert process.poll() is None, f'ended by itself:\n{output.read_text()}'
            assert len(received) >= 2, f'silent on /diagnostics:\n{output.read_text()}'
            assert all(message.status for message in received)
            process.send_signal(end)
            code = process.wait(timeout=END_S)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
    assert code == 0, f'ended with {code}:\n{output.read_text()}'
    assert 'Traceback' not in output.read_text()
