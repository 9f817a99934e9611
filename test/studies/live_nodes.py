"""Nodes in real time: the sample trial played to them, their shares of a core and their delays."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.core.resources import share_path
from trawl_ros.core.time import SECOND
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.running.monitor import Monitor
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes, Value
from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.nodes.identification_node import STATUS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER

BAG = 'sea_trial'
PLAYER, LOOK_S = 'bag_player', 0.5


@dataclass(frozen=True)
class LiveNodes:
    """Live run of nodes, `identification_node` among them.

    Attributes
    ----------
    shares
        Of a core (%), by node, by the processor time of its whole process.
    delays_s
        Time from the end of each steady window to the estimate with it.
    motion_delays_s
        The same of each half minute of a tow, all of which is learned from.
    windows, wall_s
        Steady windows so far at the end, and wall time that was measured.
    """

    shares: Mapping[str, float]
    delays_s: tuple[float, ...]
    motion_delays_s: tuple[float, ...]
    windows: int
    wall_s: float


class EstimateMonitor(Monitor):
    """Monitor of `identification_node`'s status, whose stamp is the end of the newest window.

    What all of the tow tells has a stamp of its own there, the end of its newest half minute.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._heard_at: dict[int, int] = {}
        self._motion_heard_at: dict[float, int] = {}
        self._windows = 0

    @property
    def playing(self) -> bool:
        """True if the graph's clock has begun to run."""
        return self._node.now() > 0

    @property
    def windows(self) -> int:
        """Number of windows that the newest estimate has used."""
        return self._windows

    def delays_s(self) -> list[float]:
        """Time (s) on the graph's clock from each window's end to the estimate with it."""
        return [(heard - end) / SECOND for end, heard in sorted(self._heard_at.items())]

    def motion_delays_s(self) -> list[float]:
        """Time (s) on the graph's clock from the end of each half minute of a tow that was learned
        from to the estimate with it.
        """
        found = sorted(self._motion_heard_at.items())
        return [heard / SECOND - end for end, heard in found]

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to the status."""

        def hear(message: Any) -> None:
            coefficients, *others = (status.values for status in read_statuses(message))
            # Of all others that of all of the tow alone has a stamp.
            for values in others:
                if 'stamp' in values:
                    self._motion_heard_at.setdefault(float(values['stamp']), node.now())
            self._windows = int(coefficients['windows'])
            if self._windows:
                # A refused window brings a status too, with the stamp of the estimate there is.
                self._heard_at.setdefault(stamp_of(message), node.now())

        node.listen(STATUS, hear, CONSUMER)


class _Shares:
    """Processor time of processes since a moment."""

    def __init__(self, processes: Mapping[str, psutil.Process]) -> None:
        self._processes = processes
        self._began, self._before = time.monotonic(), self._used()
        self._after, self.wall_s = self._before, 0.0

    def look(self) -> None:
        """Note what they have used up to now."""
        self._after, self.wall_s = self._used(), time.monotonic() - self._began

    def of_core(self) -> dict[str, float]:
        """Share of a core (%) of each."""
        wall_s = self.wall_s or math.nan
        return {name: 100.0 * (self._after[name] - self._before[name]) / wall_s
                for name in self._processes}  # fmt: skip

    def _used(self) -> dict[str, float]:
        times = {name: process.cpu_times() for name, process in self._processes.items()}
        return {name: used.user + used.system for name, used in times.items()}


def live_nodes(
    nodes: Mapping[str, Mapping[str, Value]],
    seconds: float,
    logs: Path,
    on_progress: OnProgress,
    before_s: float = 0.0,
) -> LiveNodes:
    """Play the sample trial to nodes in real time.

    Parameters
    ----------
    nodes
        Nodes with their parameters.
    seconds
        Length of the stretch in real time.
    logs
        Takes what the nodes say.
    on_progress
        Called now and then with the wall time (s) that has passed.
    before_s
        Beginning of the trial that is played before, as fast as the nodes follow.

    Raises
    ------
    NodeFailed
        If a node ends by itself, or cannot end cleanly.
    """
    bag: dict[str, Value] = {
        'bag': str(share_path('bags', BAG)),
        'publish_clock': True,
        'wait_for': [*nodes],
    }
    with (
        own_graph(logs) as environment,
        Processes(logs, environment) as processes,
        EstimateMonitor(environment) as monitor,
    ):
        for node, parameters in nodes.items():
            processes.start(node, use_sim_time=True, **parameters)
        if before_s:
            processes.start(PLAYER, rate=0.0, end=before_s, **bag)
            while not processes.finished(PLAYER):
                time.sleep(LOOK_S)
                on_progress(WorkProgress('what comes before', monitor.windows, None, 'windows'))
        known, known_in_motion = len(monitor.delays_s()), len(monitor.motion_delays_s())
        processes.start(PLAYER, start=before_s, end=before_s + seconds, **bag)
        pids = processes.pids()
        running = {node: psutil.Process(pids[node]) for node in nodes}
        used: _Shares | None = None
        while not processes.finished(PLAYER):
            time.sleep(LOOK_S)
            # A node's start is no part of what it takes while it runs.
            if monitor.playing:
                used = used or _Shares(running)
                used.look()
                detail = f'{monitor.windows} windows'
                on_progress(WorkProgress('in real time', used.wall_s, seconds, 's', detail))
        delays, in_motion = monitor.delays_s()[known:], monitor.motion_delays_s()[known_in_motion:]
        windows = monitor.windows
        processes.stop(*nodes)
    shares = used.of_core() if used else dict.fromkeys(nodes, math.nan)
    return LiveNodes(shares, tuple(delays), tuple(in_motion), windows, used.wall_s if used else 0.0)


def delay_row(
    what: str, delays_s: Sequence[float], most_s: float, latest: str, more: str = ''
) -> MeasuredValue:
    """Row of the latest of some delays; without any it is a miss."""
    delays = np.array(delays_s)
    least, most = (delays.min(), delays.max()) if len(delays) else (math.nan, math.nan)
    note = f'the latest of {len(delays)}{latest}; least and most{more}'
    target = at_most(most_s)
    return MeasuredValue(what, float(most), 's', target, note, float(least), float(most))


def share_row(what: str, found: LiveNodes, most: float, note: str) -> MeasuredValue:
    """Row of the share of a core of all nodes together."""
    return MeasuredValue(what, sum(found.shares.values()), '%', at_most(most), note)
