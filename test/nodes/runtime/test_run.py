"""However a node ends, it does so with an exit code, and with a sentence where one is due."""

import os
import signal
import subprocess
import sys
import time

import pytest

rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.core.errors import BagError  # noqa: E402
from trawl_ros.nodes.runtime.node import TrawlNode  # noqa: E402
from trawl_ros.nodes.runtime.run import run  # noqa: E402

pytestmark = pytest.mark.ros

NODE = """\
import sys
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.run import run

class Tried(TrawlNode):
    DRAINS = True

    def __init__(self, **kwargs):
        super().__init__('tried', **kwargs)
        print('up', flush=True)
        self.every(0.2, self.act)

    def act(self):
        {act}

    def finish_work(self):
        print('finished', flush=True)

sys.exit(run(Tried, sys.argv))
"""


@pytest.fixture
def start():
    started = []

    def start_node(act, *arguments, **environment):
        process = subprocess.Popen(
            [sys.executable, '-c', NODE.format(act=act), *arguments],
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        started.append(process)
        return process

    yield start_node
    for process in started:
        if process.poll() is None:
            process.kill()
            process.communicate()


class Tried(TrawlNode):
    DRAINS = True

    def __init__(self, act, **kwargs):
        super().__init__('tried', **kwargs)
        self.every(0.02, lambda: act(self))

    def finish_work(self):
        sys.stdout.write('finished\n')


def test_an_error_while_it_runs_is_one_sentence(capfd):
    def fail(node):
        raise BagError('trial: disk full')

    assert run(lambda: Tried(fail), ['tried']) == 1
    said = capfd.readouterr()
    (line,) = said.err.splitlines()
    assert line.startswith('[ERROR]')
    assert line.endswith(': disk full')
    assert said.out == 'finished\n'


@pytest.mark.parametrize('code', [0, 3])
def test_a_node_may_end_by_itself(capfd, code):
    assert run(lambda: Tried(lambda node: node.end(code)), ['tried']) == code
    assert capfd.readouterr().out == 'finished\n'


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM], ids=lambda n: n.name)
def test_signals_end_it_cleanly_even_when_they_come_twice(start, number):
    process = start('pass')
    assert process.stdout.readline() == 'up\n'
    process.send_signal(number)
    time.sleep(0.05)
    process.send_signal(number)
    output, errors = process.communicate(timeout=20.0)
    assert (process.returncode, output, errors) == (0, 'finished\n', '')


def test_a_node_that_compiles_answers_a_signal(start):
    watch = "__import__('trawl_ros.core.first_start', fromlist=['']).COMPILATION"
    act = f"{watch}.begin(); print('begun', flush=True); [{watch}.step() for _ in iter(int, 1)]"
    process = start(act)
    assert [process.stdout.readline() for _ in range(2)] == ['up\n', 'begun\n']
    process.send_signal(signal.SIGINT)
    output, errors = process.communicate(timeout=20.0)
    # The timer may be due again while it ends.
    assert (process.returncode, output.replace('begun\n', '')) == (0, 'finished\n')
    # Where the machine is busy, it has said by then that it compiles.
    assert all('compiling the loops' in line for line in errors.splitlines())


@pytest.mark.parametrize('home', ['/', '~', '/nowhere', ''])
def test_a_node_needs_no_home(start, tmp_path, home):
    # Root can write to any folder.
    home = home if os.getuid() or home != '/' else '/proc'
    work = {'HOME': home, 'ROS_LOG_DIR': '', 'TMPDIR': str(tmp_path)}
    output, _ = start('self.end(0)', **work).communicate(timeout=20.0)
    assert output == 'up\nfinished\n'
    assert (tmp_path / f'trawl_ros-{os.getuid()}' / '.ros').is_dir()


def test_the_namespace_may_be_another():
    found = []

    def act(node):
        found.append(node.full_name('truth/winch'))
        node.end(0)

    assert run(lambda: Tried(act), ['tried', '--ros-args', '-r', '__ns:=/training']) == 0
    assert set(found) == {'/training/truth/winch'}
