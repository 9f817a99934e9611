"""The same tow with a process per node, as users start them."""

import signal
import subprocess
import sys
from collections import Counter
from importlib import import_module
from types import SimpleNamespace

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from rosbags.rosbag2 import Reader  # noqa: E402

from trawl_ros.bags.reader import Bag  # noqa: E402
from trawl_ros.messages.diagnostics import read_statuses  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.qos import CONSUMER  # noqa: E402

pytestmark = pytest.mark.ros

INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
TRUTHS = 241


class Monitor(TrawlNode):
    """Keeps the last that each node said of its messages."""

    def __init__(self, **kwargs):
        super().__init__('monitor', **kwargs)
        self.last = {}
        self.listen('/diagnostics', self._hear, CONSUMER)

    def _hear(self, message):
        for status in read_statuses(message):
            if status.name.endswith(': messages'):
                self.last[status.hardware_id] = status.values

    def published(self):
        """Counts by topic over all nodes."""
        counts = Counter()
        for values in self.last.values():
            for key, value in values.items():
                direction, _, topic = key.partition(' ')
                if direction == 'published' and topic.startswith('/trawl/'):
                    counts[topic] += int(value)
        return counts


def words_of(parameters):
    """Parameters as words of a command line."""
    words = [word for key, value in parameters.items() for word in ('-p', f'{key}:={value}')]
    return ['--ros-args', *words] if words else []


@pytest.fixture
def start():
    """Start a node as a process; all that still run are ended afterwards."""
    started = []

    def start_node(name, **parameters):
        code = (
            f"import sys; sys.argv[0] = '{name}'; from trawl_ros.nodes.{name} import main; "
            'sys.exit(main())'
        )
        process = subprocess.Popen(
            [sys.executable, '-c', code, *words_of(parameters)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        started.append(process)
        return process

    yield start_node
    for process in started:
        if process.poll() is None:
            process.kill()
        process.wait()
        process.stdout.close()


def ended(process, number):
    """Send a signal and give exit code and output."""
    process.send_signal(number)
    output, _ = process.communicate(timeout=20.0)
    return process.returncode, output


@pytest.fixture
def tow(start, open_graph, scenario_path, tmp_path, monkeypatch):
    path = tmp_path / 'bag'
    scenario = str(scenario_path)
    with open_graph() as graph:
        for name, value in graph.environment.items():
            monkeypatch.setenv(name, value)
        monitor = graph.add(Monitor)
        recorder = start('bag_recorder', output=path, use_sim_time='true')
        instruments = [
            start(name, scenario=scenario, use_sim_time='true', wait_for='[bag_recorder]')
            for name in INSTRUMENTS
        ]
        names = ','.join(('bag_recorder', *INSTRUMENTS))
        simulation = start(
            'sim_node', scenario=scenario, time_scale=0, exit_at_end='true', wait_for=f'[{names}]'
        )
        graph.until(lambda: simulation.poll() is not None, 90.0)
        ends = {'sim_node': (simulation.returncode, simulation.communicate()[0])}
        for number, (name, process) in enumerate(zip(INSTRUMENTS, instruments, strict=True)):
            ends[name] = ended(process, (signal.SIGINT, signal.SIGTERM)[number % 2])
        ends['bag_recorder'] = ended(recorder, signal.SIGINT)
        graph.rest(0.3)
        return SimpleNamespace(path=path, ends=ends, published=monitor.published())


@pytest.mark.slow
def test_a_tow_is_recorded_whole_and_every_process_ends_cleanly(tow):
    for name, (code, output) in tow.ends.items():
        assert code == 0, f'{name}: {output}'
        assert 'Traceback' not in output, f'{name}: {output}'
    recorded = Counter(raw.topic for raw in Bag(tow.path).raw())
    del recorded['/diagnostics'], tow.published['/trawl/sync/progress']
    assert recorded == +tow.published
    assert recorded['/trawl/truth/winch'] == TRUTHS
    with Reader(tow.path) as reader:
        assert sum(1 for _ in reader.messages()) == reader.message_count


@pytest.mark.parametrize(
    ('node', 'parameters', 'sentence'),
    [
        ('bag_recorder', {}, 'parameter output: missing'),
        ('bag_recorder', {'output': '{full}/mine.txt/bag'}, 'parameter output: '),
        ('bag_player', {'bag': '{full}/nothing'}, 'nothing: no such bag'),
        ('bag_player', {'bag': '{full}'}, 'expected a bag'),
        ('winch_node', {'instruments': 'unheard-of'}, 'there are: default'),
        ('sim_node', {'time_scale': -2}, '0 to 1000 (factor)'),
    ],
)
def test_what_cannot_be_ends_with_one_sentence(capfd, tmp_path, node, parameters, sentence):
    full = tmp_path / 'full'
    full.mkdir()
    (full / 'mine.txt').write_text('kept')
    words = words_of({key: str(value).format(full=full) for key, value in parameters.items()})
    assert import_module(f'trawl_ros.nodes.{node}').main([node, *words]) == 1
    (line,) = capfd.readouterr().err.strip().splitlines()
    assert line.startswith(f'{node}: ')
    assert sentence in line
    assert [file.name for file in full.iterdir()] == ['mine.txt']
