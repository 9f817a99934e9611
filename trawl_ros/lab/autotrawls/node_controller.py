# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Controller of the bench that is a node: readings go out to it, and its commands come back."""

import os
import shlex
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.autotrawls.controllers import MakeController, StandingWinches
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.messages.commands import WINCH_COMMAND, read_winch_command
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.records.samples import WinchSample
from trawl_ros.records.topics import CLOCK, NAMESPACE

WINCH = 'winch/joint_states'
SET_LENGTHS = ('port_length_m', 'starboard_length_m')
"""Parameters by which a node is given set lengths, if it has them."""

NODE_ENDS_S = 10.0
"""Time (s) for a node to end by itself, after which it is killed."""

START_S = 60.0
"""Wall time within which a node is to listen to the winches."""

ANSWER_S = 0.2
"""Wall time within which a node answers a reading; later answers go with the next one."""

SILENT_READINGS = 100
"""Readings at the start without any answer after which a node is taken to be deaf."""


class Bench(TrawlNode):
    """Publishes the readings of the winches and time, and listens to the commands."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('autotrawl_bench', **kwargs)
        self.commands: list[tuple[float | None, float | None]] = []
        for topic in (CLOCK.name, WINCH):
            self.advertise(topic)
        self.listen(WINCH_COMMAND, self._hear, CONSUMER)

    def _hear(self, message: Any) -> None:
        self.commands.append(read_winch_command(message))

    def commanding(self) -> str:
        """Return the full name of the node that commands; '' without one."""
        found = self.get_publishers_info_by_topic(self.full_name(WINCH_COMMAND))
        return f'{found[0].node_namespace.rstrip("/")}/{found[0].node_name}' if found else ''


class NodeController(StandingWinches):
    """Controller in another process.

    Parameters
    ----------
    bench, executor
        The node that speaks to it, and its executor.
    lengths
        At the start, m.
    """

    def __init__(
        self, bench: Bench, executor: SingleThreadedExecutor, lengths: tuple[float, float]
    ) -> None:
        super().__init__(lengths)
        self._bench, self._executor = bench, executor
        self._told: tuple[float, float] | None = None
        self._client = AsyncParameterClient(bench, bench.commanding())
        self._asked = self._answered = 0

    def set_lengths(self, port: float, starboard: float) -> None:
        """Set the parameters of the node, if it has them."""
        if (port, starboard) == self._told or not self._client.services_are_ready():
            return
        self._told = (port, starboard)
        values = zip(SET_LENGTHS, self._told, strict=True)
        self._client.set_parameters([Parameter(name, value=value) for name, value in values])

    def update(self, sample: WinchSample) -> tuple[float, float]:
        """Publish a sample; return the lengths (port, starboard), m, that the node wants."""
        self._bench.send(*clock_message(sample.stamp))
        self._bench.send(*sample_message(sample))
        self._asked += 1
        end = time.monotonic() + ANSWER_S
        while not self._bench.commands and time.monotonic() < end:
            self._executor.spin_once(timeout_sec=0.02)
        for port, starboard in self._bench.commands:
            self._answered += 1
            held = self.wanted
            self.wanted = (
                held[0] if port is None else port,
                held[1] if starboard is None else starboard,
            )
        self._bench.commands.clear()
        if self._asked == SILENT_READINGS and not self._answered:
            raise TrawlError(
                f'{WINCH_COMMAND}: nothing heard after {self._asked} readings; expected a node '
                f'that answers {WINCH}'
            )
        return self.wanted


@contextmanager
def node_controller(command: str, logs: Path) -> Iterator[MakeController]:
    """Start a node in a graph of its own, and yield what makes its controller.

    Parameters
    ----------
    command
        As in a shell, such as ``'python my_autotrawl.py'``; it is started with ``use_sim_time``
        in the namespace of the project.
    logs
        Folder that takes what it says.

    Raises
    ------
    TrawlError
        If it does not listen to the winches.
    """
    options = ['--ros-args', '-p', 'use_sim_time:=true', '-r', f'__ns:=/{NAMESPACE}']
    logs.mkdir(parents=True, exist_ok=True)
    with own_graph(logs) as environment, (logs / 'node.log').open('wb') as log:
        context = rclpy.Context()
        os.environ.setdefault(
            'ROS_AUTOMATIC_DISCOVERY_RANGE', environment['ROS_AUTOMATIC_DISCOVERY_RANGE']
        )
        rclpy.init(args=[], context=context, domain_id=int(environment['ROS_DOMAIN_ID']))
        bench = Bench(context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(bench)
        process = subprocess.Popen(
            [*shlex.split(command), *options],
            env={**os.environ, **environment},
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            _wait(bench, executor, process, command, logs / 'node.log')
            yield lambda lengths: NodeController(bench, executor, lengths)
        finally:
            _end(process)
            bench.destroy_node()
            executor.shutdown()
            context.try_shutdown()


def _end(process: 'subprocess.Popen[bytes]') -> None:
    """End a node: it may be on its way up, when its handler of signals is not there yet."""
    process.terminate()
    try:
        process.wait(NODE_ENDS_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _wait(
    bench: Bench,
    executor: SingleThreadedExecutor,
    process: 'subprocess.Popen[bytes]',
    command: str,
    log: Path,
) -> None:
    end = time.monotonic() + START_S
    while not bench.count_subscribers(bench.full_name(WINCH)) or not bench.commanding():
        if process.poll() is not None or time.monotonic() > end:
            said = log.read_text(encoding='utf-8', errors='replace').strip().splitlines()
            ended = process.poll()
            found = 'does not command the winches' if ended is None else f'ended with code {ended}'
            last = f' ({said[-1]})' if said else ''
            raise TrawlError(
                f'{command}: {found}{last}, expected a node in /{NAMESPACE} that listens to '
                f'{WINCH} and publishes {WINCH_COMMAND}'
            )
        executor.spin_once(timeout_sec=0.05)
