"""Nodes as child processes: what fails is said with its last words, and all end together."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')

from trawl_ros.lab.running.processes import NodeFailed, Processes

pytestmark = pytest.mark.ros

PATIENCE_S = 60.0


def running_with(marker: str) -> list[int]:
    """Processes that have a text in their environment."""
    found = []
    for entry in Path('/proc').iterdir():
        try:
            if entry.name.isdigit() and marker.encode() in (entry / 'environ').read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue
    return found


@pytest.fixture
def environment(tmp_path):
    return {'ROS_LOG_DIR': str(tmp_path / 'log')}


def wait_until(condition):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline, 'waited too long'
        time.sleep(0.1)


def test_a_node_that_fails_is_named_with_its_last_words(tmp_path, environment):
    with Processes(tmp_path / 'log', environment) as processes:
        processes.start('bag_recorder')

        def failed():
            try:
                processes.check()
            except NodeFailed as reason:
                return str(reason)
            return ''

        wait_until(failed)
        assert failed().startswith('bag_recorder ended with code 1')
        assert 'parameter output: missing' in failed()


def test_what_a_node_says_is_not_written_through_a_link(tmp_path, environment):
    logs, victim = tmp_path / 'log', tmp_path / 'victim'
    logs.mkdir()
    victim.write_text('mine')
    (logs / 'bag_recorder.txt').symlink_to(victim)
    with Processes(logs, environment) as processes:
        processes.start('bag_recorder')
        wait_until(lambda: 'missing' in (logs / 'bag_recorder.txt').read_text())
    assert victim.read_text() == 'mine'
    assert not (logs / 'bag_recorder.txt').is_symlink()


def test_a_node_ends_cleanly_when_stopped(tmp_path, environment):
    with Processes(tmp_path / 'log', environment) as processes:
        processes.start('bag_recorder', output=str(tmp_path / 'bag'))
        wait_until((tmp_path / 'bag' / 'metadata.yaml').is_file)
        processes.check()
        processes.stop('bag_recorder')
    assert running_with(str(tmp_path)) == []


def test_who_ended_by_itself_is_told_once_with_its_last_words(tmp_path, environment):
    with Processes(tmp_path / 'log', environment) as processes:
        processes.start('bag_recorder')
        over = {}
        wait_until(lambda: over.update(processes.ended()) or over)
        assert 'parameter output: missing' in over['bag_recorder']
        assert processes.ended() == {}
        processes.check()


def test_a_node_that_is_killed_is_gone_and_not_missed(tmp_path, environment):
    with Processes(tmp_path / 'log', environment) as processes:
        processes.start('winch_node')
        processes.signal('winch_node', signal.SIGSTOP)
        processes.kill('winch_node')
        assert running_with(str(tmp_path)) == []
        processes.check()
        assert processes.pids() == {}


@pytest.mark.parametrize('seconds', [0.0, 0.003, 0.01, 0.02, 0.03, 0.1])
def test_a_node_that_has_not_begun_yet_may_be_stopped(tmp_path, environment, seconds):
    with Processes(tmp_path / 'log', environment) as processes:
        processes.start('winch_node')
        time.sleep(seconds)
        processes.stop('winch_node')
    assert running_with(str(tmp_path)) == []


def test_leaving_for_whatever_reason_ends_all(tmp_path, environment):
    def tow_and_fail():
        with Processes(tmp_path / 'log', environment) as processes:
            processes.start('bag_recorder', output=str(tmp_path / 'bag'))
            processes.start('winch_node')
            wait_until(lambda: len(running_with(str(tmp_path))) == 2)
            raise RuntimeError

    with pytest.raises(RuntimeError):
        tow_and_fail()
    assert running_with(str(tmp_path)) == []


def blocked_signals(pid):
    """The mask of signals that a process has blocked."""
    status = Path(f'/proc/{pid}/status').read_text()
    (mask,) = (line.split()[1] for line in status.splitlines() if line.startswith('SigBlk'))
    return int(mask, 16)


class Interrupted(subprocess.Popen):
    """A process during whose start, once it runs, somebody presses Ctrl-C."""

    def __init__(self, *args, **kwargs):
        super().__init__(*args, **kwargs)
        wait_until(lambda: blocked_signals(self.pid) == 0)
        signal.raise_signal(signal.SIGINT)


def test_an_interruption_while_a_process_starts_leaves_it_to_be_ended(
    tmp_path, environment, monkeypatch
):
    monkeypatch.setattr(subprocess, 'Popen', Interrupted)
    handler = signal.getsignal(signal.SIGINT)

    def start():
        with Processes(tmp_path / 'log', environment) as processes:
            processes.start('winch_node')
            pytest.fail('the interruption got lost')

    with pytest.raises(KeyboardInterrupt):
        start()
    assert running_with(str(tmp_path)) == []
    assert signal.getsignal(signal.SIGINT) is handler


def test_a_second_interruption_shortens_the_wait_and_leaves_nobody(tmp_path, environment):
    deaf = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print('up', " \
        'flush=True); time.sleep(60)'  # fmt: skip
    processes = Processes(tmp_path / 'log', environment)
    process = subprocess.Popen(
        [sys.executable, '-c', deaf], stdout=subprocess.PIPE, env={**os.environ, **environment}
    )
    assert process.stdout is not None
    process.stdout.readline()
    process.stdout.close()
    processes._running['deaf'] = process
    own = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    began = time.monotonic()
    own.start()
    with pytest.raises(KeyboardInterrupt):
        processes.__exit__(None, None, None)
    assert time.monotonic() - began < 5.0
    assert running_with(str(tmp_path)) == []


def test_an_interrupted_demo_leaves_nobody_behind(tmp_path):
    out = tmp_path / 'demo'
    with (tmp_path / 'output.txt').open('w') as output:
        demo = subprocess.Popen(
            [sys.executable, '-c', 'from trawl_ros.cli.main import main; main()',
             'demo', '--out', str(out)],
            stdout=output, stderr=subprocess.STDOUT, env=os.environ,
        )  # fmt: skip
    try:
        wait_until(lambda: len(running_with(str(out))) >= 6 or demo.poll() is not None)
        demo.send_signal(signal.SIGTERM)
        code = demo.wait(timeout=30.0)
    finally:
        demo.kill()
        demo.wait()
    assert code == 1, (tmp_path / 'output.txt').read_text()
    assert 'Traceback' not in (tmp_path / 'output.txt').read_text()
    assert running_with(str(out)) == []
