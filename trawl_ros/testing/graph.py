# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""ROS graph of a test: simulation, instruments and the nodes under test."""

import inspect
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import cached_property
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
import rclpy
import yaml
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes, Value
from trawl_ros.messages.commands import fault_command, vessel_command, winch_command
from trawl_ros.messages.diagnostics import OK, Status
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.records.topics import SYNC, absolute
from trawl_ros.testing.bench import BENCH, Bench
from trawl_ros.testing.recording import Recording

SIMULATION = 'sim_node'
LEAD_S = 1.0
"""Simulated time (s) by which the simulation may be ahead of the slowest node that reports."""

STALL_S = 40.0
"""Wall time (s) without any simulated time after which a wait fails."""

LONGEST_CALLBACK_S = 1.0
"""Wall time (s) of a callback in the test's process; what it takes longer is no standstill."""

MakeExecutor = Callable[..., Executor]
NodeClass = Callable[..., Node]


def node_class(name: str) -> type[TrawlNode]:
    """Return the class of a node of the package by its executable's name.

    Raises
    ------
    TrawlError
        If there is no such node.
    """
    path = f'trawl_ros.nodes.{name}'
    try:
        module = import_module(path)
    except ModuleNotFoundError as reason:
        raise TrawlError(
            f'{name}: no node of trawl_ros; expected a name such as winch_node, or a class'
        ) from reason
    own = (kind for kind in vars(module).values() if getattr(kind, '__module__', '') == path)
    for kind in own:
        if inspect.isclass(kind) and issubclass(kind, TrawlNode) and not inspect.isabstract(kind):
            return kind
    raise TrawlError(f'{name}: its module has no node; expected a name such as winch_node')


class Graph:
    """Nodes in one executor, context and domain of their own; made by `open_graph`.

    Attributes
    ----------
    environment : dict
        Environment variables that put another process into this graph.
    context : rclpy.Context
        Context of the nodes in this process.
    executor : rclpy.executors.Executor
        Spins the nodes in this process, only while the graph waits.
    """

    def __init__(
        self,
        environment: Mapping[str, str],
        make_executor: MakeExecutor | None = None,
        processes: Processes | None = None,
    ) -> None:
        self.environment = dict(environment)
        self._processes = processes
        self._common: dict[str, Value] = {}
        self._simulated = False
        self.context = rclpy.Context()
        with pytest.MonkeyPatch.context() as patch:
            for name, value in environment.items():
                patch.setenv(name, value)
            domain = int(environment['ROS_DOMAIN_ID'])
            rclpy.init(args=[], context=self.context, domain_id=domain)
        self.executor = (make_executor or SingleThreadedExecutor)(context=self.context)

    def add(self, kind: str | NodeClass, **parameters: Any) -> Any:
        """Start a node.

        Parameters
        ----------
        kind
            Name of a node of the package, or a class that passes its keyword arguments on to
            `rclpy.node.Node`.
        **parameters
            ROS parameters of the node.

        Returns
        -------
        Node or None
            The node; None if it runs as a process.
        """
        common = self._common
        if isinstance(kind, str):
            specs = {'use_sim_time', *(spec.name for spec in node_class(kind).SPECS)}
            parameters = {**{k: v for k, v in common.items() if k in specs}, **parameters}
            if self._processes is not None:
                return self._processes.start(kind, **parameters)
            made: NodeClass = node_class(kind)
        else:
            made = kind
            parameters = {'use_sim_time': True, **parameters} if common else parameters
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = made(context=self.context, parameter_overrides=overrides)
        self.executor.add_node(node)
        return node

    def simulate(self, scenario: str, nodes: Sequence[str | NodeClass]) -> None:
        """Start a simulation, the nodes that observe it, and those under test."""
        self._common = {'use_sim_time': True, 'scenario': scenario}
        named = [node for node in nodes if isinstance(node, str)]
        self._simulated = True
        self.bench.follow()
        for node in nodes:
            self.add(node)
        self.add(
            SIMULATION, use_sim_time=False, time_scale=0.0, lead_s=LEAD_S, winches='command',
            wait_for=[BENCH, *(name for name in named if _reports(name))],
        )  # fmt: skip

    @cached_property
    def bench(self) -> Bench:
        """Node by which the test takes part in the graph."""
        bench: Bench = self.add(Bench, **({'use_sim_time': True} if self._simulated else {}))
        return bench

    @property
    def time_s(self) -> float:
        """Simulated time, s; 0 before the first ``/clock``."""
        return self.bench.now() / 1e9 if self._simulated else 0.0

    def until(self, condition: Callable[[], object], timeout_s: float = STALL_S) -> None:
        """Spin until a condition holds.

        Parameters
        ----------
        condition
            Called after each callback.
        timeout_s
            Simulated time, s; wall time in a graph without a scenario. Simulated time that stands
            still for `STALL_S` of wall time fails as well.

        Raises
        ------
        AssertionError
            With what was not heard, and what nodes say of themselves.
        """
        began, since, latest = self.time_s, time.monotonic(), -1.0
        while not condition():
            now, wall = self.time_s, time.monotonic()
            if now != latest and self._simulated:
                latest, since = now, wall
            if now - began > timeout_s:
                raise AssertionError(self._failure(f'{timeout_s:g} s of simulated time'))
            if wall - since > (STALL_S if self._simulated else timeout_s):
                raise AssertionError(self._failure(f'{wall - since:.0f} s of wall time'))
            self.executor.spin_once(timeout_sec=0.05)
            # A node that compiles its loops, as in the first run, does not stand still.
            since += max(0.0, time.monotonic() - wall - LONGEST_CALLBACK_S)
            if self._processes is not None:
                self._processes.check()

    def wait(self, seconds: float) -> None:
        """Let simulated time (s) go by."""
        end = self.time_s + seconds
        self.until(lambda: self.time_s >= end, seconds + 60.0)

    def rest(self, seconds: float) -> None:
        """Spin for some wall time (s)."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)

    def settle(self, quiet_s: float = 0.5) -> None:
        """Spin until nothing has arrived for some wall time (s); heartbeats do not count."""
        arrived = -1
        while arrived != (arrived := self._arrived()):
            self.rest(quiet_s)

    def _arrived(self) -> int:
        return sum(
            number
            for node in self.executor.get_nodes()
            if isinstance(node, TrawlNode)
            for topic, number in node.traffic.counts('received').items()
            if not topic.endswith(('/diagnostics', f'/{SYNC}'))
        )

    def record(self, topic: str, type_name: str | None = None) -> Recording:
        """Record a topic from now on.

        Parameters
        ----------
        topic
            Name, relative to ``/trawl`` or absolute.
        type_name
            Type such as ``geometry_msgs/msg/Wrench``; not needed for topics of the package.
        """
        return self.bench.record(topic, type_name)

    def status(self, name: str) -> Status:
        """Return the newest status of ``/diagnostics`` by name, such as ``'sim_node: tow'``.

        Before the first one its message is empty.
        """
        return self.bench.latest.get(absolute(name), Status(name, OK, ''))

    def call(self, service: str) -> Any:
        """Call a service of type ``std_srvs/Trigger``, and return its response."""
        client = self.bench.create_client(Trigger, service)
        self.until(client.service_is_ready)
        future = client.call_async(Trigger.Request())
        self.until(future.done)
        self.bench.destroy_client(client)
        return future.result()

    def command_winches(self, port_m: float, starboard_m: float) -> None:
        """Command warp lengths, m; NaN leaves a winch as it is."""
        self.send(*winch_command(self.bench.now(), port_m, starboard_m))

    def command_ship(self, speed_m_s: float, turn_rate_rad_s: float) -> None:
        """Command speed through the water and rate of turn, which is positive to port."""
        self.send(*vessel_command(self.bench.now(), speed_m_s, turn_rate_rad_s))

    def fault(self, where: str, what: str) -> None:
        """Switch a fault: ``fault('winch/joint_states/port/tension', 'lost')``; 'none' ends it."""
        self.send(*fault_command(where, what))

    def send(self, topic: str, message: Any) -> None:
        """Publish a message as soon as somebody listens."""
        sender = self.bench.advertise(topic, message.__msgtype__)
        self.until(sender.get_subscription_count)
        self.bench.send(topic, message)

    def remove(self, node: Node) -> None:
        """Take a node out of the graph."""
        self.executor.remove_node(node)
        node.destroy_node()

    def close(self) -> None:
        """Destroy all nodes of this process."""
        for node in list(self.executor.get_nodes()):
            self.remove(node)
        self.executor.shutdown()
        self.context.try_shutdown()

    def _failure(self, waited: str) -> str:
        said = [f'{name} has ended with code {code}' for name, code in self._ended()]
        lines = ['; '.join([f'not so within {waited}', *said]), *self.bench.complaints()]
        return '\n  '.join(lines)

    def _ended(self) -> Iterator[tuple[str, int]]:
        for node in self.executor.get_nodes():
            if isinstance(node, TrawlNode) and node.exit_code is not None:
                yield node.get_name(), node.exit_code


def _reports(name: str) -> bool:
    """True if a node of the package reports its progress to the simulation by itself."""
    return name in ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')


@contextmanager
def open_graph(
    nodes: Sequence[str | NodeClass] = (),
    scenario: str | Path | Mapping[str, Any] | None = None,
    *,
    processes: bool = False,
    make_executor: MakeExecutor | None = None,
) -> Iterator[Graph]:
    """Open a graph in a ROS domain of its own, which other tests do not hear.

    Parameters
    ----------
    nodes
        Names of nodes of the package such as ``'winch_node'``, and classes of nodes under test.
    scenario
        Name, file or content of a scenario. It moves the ship, and ``command/winch`` the winches.
        The simulation runs as fast as the nodes follow. Without a scenario there is none.
    processes
        Whether nodes of the package run as processes; classes run in the test's process.
    make_executor
        Makes the executor of the nodes in the test's process; single-threaded by default.

    Raises
    ------
    TrawlError
        If a name is unknown, a scenario is wrong, or all domains are in use.

    Examples
    --------
    >>> from trawl_ros.testing import open_graph
    >>> with open_graph(['winch_node'], scenario='rough_sea') as graph:
    ...     winch = graph.record('winch/joint_states')
    ...     graph.wait(5.0)
    ...     winch.latest.name
    ['port_warp', 'starboard_warp']
    """
    with ExitStack() as stack:
        folder = Path(stack.enter_context(TemporaryDirectory(prefix='trawl_ros-')))
        environment = stack.enter_context(own_graph(folder))
        run = stack.enter_context(Processes(folder, environment)) if processes else None
        graph = Graph(environment, make_executor, run)
        stack.callback(graph.close)
        if scenario is None:
            for node in nodes:
                graph.add(node)
        else:
            graph.simulate(_scenario_path(scenario, folder), nodes)
        yield graph


def _scenario_path(scenario: str | Path | Mapping[str, Any], folder: Path) -> str:
    if not isinstance(scenario, Mapping):
        # A process has the same folder, but a name of the package is no file.
        return os.fspath(scenario)
    path = folder / 'scenario.yaml'
    path.write_text(yaml.safe_dump(dict(scenario)), encoding='utf-8')
    return str(path)
