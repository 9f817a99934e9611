"""Chain of nodes watched while it runs: memory, processor time, and delay behind the truth."""

import time
from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import fmean
from typing import Any

import psutil

from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.core.time import SECOND
from trawl_ros.lab.running.chain import MEGABYTE, SIMULATION, stop_chain
from trawl_ros.lab.running.monitor import Monitor
from trawl_ros.lab.running.processes import Processes
from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.messages.stamps import from_time, stamp_of
from trawl_ros.nodes.identification_node import STATUS
from trawl_ros.nodes.runtime.credit import HEADER, consumer_of
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.records.topics import SYNC

LOOK_S = 0.2
BAG_PART_S = 600.0
"""Data time after which the recorder begins a new file: the index of a day in one is large."""

TRUTH = 'truth/winch'
"""The topic whose stamps are the simulation's present."""


@dataclass(frozen=True)
class Glance:
    """Glance at the running chain at one time.

    ``data_s`` is the stamp of the newest truth and ``wall_s`` wall time since the first truth.
    By node: ``memory_mb`` is resident memory, ``cpu_s`` the processor time since its start,
    ``delay_s`` the mean data time since the glance before by which it was behind the truth.
    """

    data_s: float
    wall_s: float
    memory_mb: Mapping[str, float]
    cpu_s: Mapping[str, float]
    delay_s: Mapping[str, float]


class DelayMonitor(Monitor):
    """Monitor of diagnostics, truth and the nodes' reports on ``sync/progress``.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._truth: int | None = None
        self._done: dict[str, int] = {}

    @property
    def truth_s(self) -> float | None:
        """Stamp of the newest truth, s; None before the first."""
        truth = self._truth
        return None if truth is None else truth / SECOND

    def delays_s(self) -> dict[str, float]:
        """Delay of each node in data time (s) behind the newest truth."""
        truth = self._truth
        if truth is None:
            return {}
        return {node: (truth - done) / SECOND for node, done in list(self._done.items())}

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to truth and progress."""
        node.listen(TRUTH, self._hear_truth, CONSUMER)
        node.listen(SYNC, self._hear_progress, CONSUMER, HEADER)

    def _hear_truth(self, message: Any) -> None:
        self._truth = stamp_of(message)

    def _hear_progress(self, message: Any) -> None:
        self._done[consumer_of(message)[0]] = from_time(message.stamp)


class JournalMonitor(DelayMonitor):
    """Monitor of the wall time of each truth, and of the newest status of the estimate.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.

    Attributes
    ----------
    coefficients
        Values of the newest ``identification/status``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._stamps: list[int] = []
        self._walls: list[float] = []
        self.coefficients: Mapping[str, str] = {}

    def longest_silence_s(self) -> float:
        """Return the longest wall time (s) between two truths."""
        walls = self._walls
        return max((b - a for a, b in pairwise(walls)), default=0.0)

    def first_after(self, stamp: int) -> float | None:
        """Return the wall time at which the first truth after a stamp (ns) was heard."""
        index = bisect_right(self._stamps, stamp)
        return self._walls[index] if index < len(self._walls) else None

    def done_s(self, node: str) -> float:
        """Data time (s) that a consumer has dealt with, by its last report."""
        return self._done.get(node, 0) / SECOND

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to the estimate, too."""
        super().listen_to_more(node)
        node.listen(STATUS, self._hear_status, CONSUMER)

    def _hear_truth(self, message: Any) -> None:
        stamp = stamp_of(message)
        # A stranger repeats what was there already.
        if not self._stamps or stamp > self._stamps[-1]:
            super()._hear_truth(message)
            self._walls.append(time.monotonic())
            self._stamps.append(stamp)

    def _hear_status(self, message: Any) -> None:
        self.coefficients = read_statuses(message)[0].values


def watch_chain(
    processes: Processes,
    monitor: DelayMonitor,
    every_s: float,
    stage: WorkProgress,
    on_progress: OnProgress,
    stop: Callable[[], bool],
) -> list[Glance]:
    """Monitor a running chain until its scenario ends, and end it in good order.

    Parameters
    ----------
    processes, monitor
        The chain, started, and who listens to it.
    every_s
        Data time (s) from one glance to the next.
    stage, on_progress
        Stage of the work; called now and then with the data time (s) that is reached in it.
    stop
        Asked now and then whether to end before the scenario does.

    Raises
    ------
    NodeFailed
        If a node ends by itself, or cannot end cleanly.
    """
    watched = watched_of(processes)
    glances: list[Glance] = []
    delays: dict[str, list[float]] = {}
    began: float | None = None
    while not stop() and not processes.finished(SIMULATION):
        time.sleep(LOOK_S)
        if (data_s := monitor.truth_s) is None:
            continue
        began = time.monotonic() if began is None else began
        for node, delay in monitor.delays_s().items():
            delays.setdefault(node, []).append(delay)
        on_progress(replace(stage, done=data_s))
        if not glances or data_s >= glances[-1].data_s + every_s:
            means = {node: fmean(found) for node, found in delays.items()}
            seen = glance(watched, data_s, time.monotonic() - began, means)
            if seen is not None:
                glances.append(seen)
            delays = {}
    stop_chain(processes)
    return glances


def watched_of(processes: Processes) -> dict[str, psutil.Process]:
    """Return the running processes by node."""
    return {node: psutil.Process(pid) for node, pid in processes.pids().items()}


def glance(
    watched: Mapping[str, psutil.Process],
    data_s: float,
    wall_s: float,
    delays: Mapping[str, float],
) -> Glance | None:
    """Measure processes by node; None where one of them is about to end."""
    memory, cpu = {}, {}
    try:
        for node, process in watched.items():
            with process.oneshot():
                memory[node] = process.memory_info().rss / MEGABYTE
                times = process.cpu_times()
                cpu[node] = times.user + times.system
    except psutil.NoSuchProcess:
        return None
    if not all(memory.values()):
        # The simulation has come to its end since it was asked, and holds no memory any more.
        return None
    return Glance(data_s, wall_s, memory, cpu, delays)
