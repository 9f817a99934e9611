"""Execution of the commands of a document, in one folder that holds what a checkout does.

What a command needs of others, a folder that they make by ``--out`` for instance, is made by
running these first, each of them once.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from promised.documents import ROOT, Document, Promise

NODE_STARTS_S = 60.0
NODE_RUNS_S = 2.0
NODE_ENDS_S = 30.0
PROGRESS = re.compile('(reading|solving|exporting|repairing|compared changes|changes):')
"""What is said every ten seconds on a slow machine."""

RENAMED = re.compile(r'__node:=(\w+)')

NOT_RUN = {
    **dict.fromkeys(
        ('rosdep install', 'python3 -m venv --system-site-packages', "pip install 'cma"),
        'for machines with ROS 2; it would change the environment of the test',
    ),
    'ros2 security create_keystore keystore': 'needs a full ROS 2',
    'ros2 security generate_artifacts -k keystore -p policy.xml': 'needs a full ROS 2',
    'bash sign.sh': 'needs a keystore of a full ROS 2',
    'ros2 launch trawl_ros': 'needs a full ROS 2',
    "pip install 'trawl_ros[view]'": 'it would change the environment of the test',
    **dict.fromkeys(
        (
            'python3 -m venv ~/trawl',
            "pip install '.[ros]'",
            '~/trawl/bin/pip install',
            'make wheel',
        ),
        'test/packaging builds the wheel and installs it in an environment of its own',
    ),
}
"""Commands that cannot be run by a test, and why."""

NEEDS = {
    'trawl view': ('rerun', 'make test-view'),
    'ros2 run trawl_ros view_node': ('rerun', 'make test-view'),
}
"""Modules without which commands are not run, and what installs them, by the beginning."""

ENDS = {
    'trawl bag check sea_trial --require': 3,
    'trawl bag check cut.mcap': 3,
    'trawl bag repair cut.mcap': 3,
    'trawl diagnose': 10,
    'trawl gear state kaifuha --warp 200 --speed 3.0': 1,
    'bash secured.sh winch_node': 1,
}
"""Exit codes that documents state, by the beginning of the command; 0 else."""

BESIDE = {
    'ros2 run trawl_ros bag_recorder': 'sim_node',
    'ros2 topic pub --once /trawl/command/fault': 'winch_node',
    'ros2 param set /trawl/door_sensor_node': 'door_sensor_node',
}
"""Nodes that run meanwhile, by the beginning of the command."""


def by_beginning(table: dict, command: str, default: object = None):
    return next((value for key, value in table.items() if command.startswith(key)), default)


class Story:
    """The commands of a document, in one folder that looks like a checkout."""

    def __init__(self, document: Document, folder: Path) -> None:
        self.document = document
        self.folder = folder
        self.seconds: dict[Promise, float] = {}
        for entry in ROOT.iterdir():
            if entry.name in ('bags', 'config'):
                shutil.copytree(entry, folder / entry.name)
            elif entry.name not in ('.git', 'out', 'build', 'install', 'log'):
                (folder / entry.name).symlink_to(entry)
        for name, text in document.files.items():
            file = folder / name
            assert not file.is_symlink(), f'{document.name}: {name} is a file of the checkout'
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        (folder / 'programs').mkdir()
        (folder / 'programs/ros2').symlink_to(Path(__file__).parents[1] / 'ros2')
        path = (str(folder / 'programs'), str(Path(sys.executable).parent), os.environ['PATH'])
        self.environment = {
            **os.environ,
            'COLCON_HOME': str(folder / '.colcon'),
            # What is installed stands, or `make` would install this folder.
            'MAKEFLAGS': '-o .venv/ready',
            'MPLBACKEND': 'Agg',
            'PATH': os.pathsep.join(path),
            'ROS_LOG_DIR': str(folder / '.log'),
        }

    def run(self, promise: Promise) -> None:
        """Run a command, if it was not yet, after those whose files it needs."""
        module, by = by_beginning(NEEDS, promise.text, ('pytest', ''))
        pytest.importorskip(module, reason=f'needs {module}, which {by} installs')
        for step in (*self.document.before(promise), promise):
            if step not in self.seconds:
                self.seconds[step] = self._run(step)

    def _run(self, promise: Promise) -> float:
        beside = by_beginning(BESIDE, promise.text)
        if beside is None:
            return self._timed(promise)
        with self._node(f'ros2 run trawl_ros {beside}', beside):
            return self._timed(promise)

    def _timed(self, promise: Promise) -> float:
        begin = time.monotonic()
        if promise.node is None:
            self._command(promise)
        else:
            renamed = RENAMED.search(promise.text)
            with self._node(promise.text, renamed[1] if renamed else promise.node):
                pass
        return time.monotonic() - begin

    def _command(self, promise: Promise) -> None:
        python = promise.language == 'python'
        program = [sys.executable, '-c'] if python else ['bash', '-eo', 'pipefail', '-c']
        done = subprocess.run(
            [*program, promise.text],
            cwd=self.folder,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        wanted = by_beginning(ENDS, promise.text, 0)
        assert done.returncode == wanted, f'{promise.place}: {done.returncode}\n{done.stdout}'
        assert 'Traceback' not in done.stdout, f'{promise.place}\n{done.stdout}'
        if promise.printed is not None:
            compare(promise, done.stdout)

    @contextmanager
    def _node(self, command: str, node: str) -> Iterator[None]:
        """Start a node, wait until it says how it is, and end it as Ctrl-C does."""
        log = self.folder / f'{node}.txt'
        with log.open('w') as output:
            process = subprocess.Popen(
                ['bash', '-c', command],
                cwd=self.folder,
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        try:
            wait_for_word_of(node, process)
            yield
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            try:
                code = process.wait(NODE_ENDS_S)
            except subprocess.TimeoutExpired:
                process.kill()
                code = process.wait()
        text = log.read_text()
        assert code == 0, f'{command}: {code}\n{text}'
        assert 'Traceback' not in text, f'{command}\n{text}'


def wait_for_word_of(node: str, process: subprocess.Popen) -> None:
    """Wait until a node reports on /diagnostics, and for what it does in its first seconds."""
    rclpy = pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    from diagnostic_msgs.msg import DiagnosticArray

    context = rclpy.Context()
    rclpy.init(args=[], context=context)
    listener = rclpy.create_node('reader_of_documents', context=context)
    heard: set[str] = set()
    listener.create_subscription(
        DiagnosticArray,
        '/diagnostics',
        lambda message: heard.update(status.hardware_id for status in message.status),
        10,
    )
    executor = rclpy.executors.SingleThreadedExecutor(context=context)
    executor.add_node(listener)
    end = time.monotonic() + NODE_STARTS_S
    try:
        while not any(name.endswith(node) for name in heard) and process.poll() is None:
            assert time.monotonic() < end, f'{node} says nothing'
            executor.spin_once(timeout_sec=0.1)
    finally:
        executor.shutdown()
        listener.destroy_node()
        context.try_shutdown()
    time.sleep(NODE_RUNS_S)


def compare(promise: Promise, output: str) -> None:
    """Hold what a command prints against what the document shows; … stands for any lines."""
    lines = [line.rstrip() for line in output.splitlines() if not PROGRESS.match(line)]
    pattern = '\n'.join(
        r'(?:.*\n)*?.*' if line == '…' else re.escape(line.rstrip()) for line in promise.printed
    )
    shown = '\n'.join(lines)
    assert re.fullmatch(pattern, shown), f'{promise.place} prints\n{shown}'
