"""Live chain: identification and watch beside one another, on a bag in motion in real time."""

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil

from trawl_ros.core.errors import RosMissing
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.core.resources import share_path
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes, Value

BAG = 'sea_trial'

BEFORE_S = 1500.0
"""Beginning of the bag that is played as fast as the nodes follow, so that all of a tow so far is
learned from and watched when real time begins."""

NODES: Mapping[str, Mapping[str, Value]] = {
    'identification_node': {},
    'discrepancy_node': {'watch': True},
}
"""Nodes of the chain with their parameters, of the gear as it ships."""

PLAYER, LOOK_S = 'bag_player', 0.5

MOST_OF_CORE, LATEST_S = 15.0, 5.0


@dataclass(frozen=True)
class LiveChain:
    """Live run of the chain.

    Attributes
    ----------
    shares
        Of a core (%), by node, by the processor time of its whole process.
    delays_s
        Time from the end of each half minute to the estimate with it.
    windows, wall_s
        Steady windows so far at the end, and wall time that was measured.
    """

    shares: Mapping[str, float]
    delays_s: tuple[float, ...]
    windows: int
    wall_s: float


@dataclass
class _Shares:
    """Processor time of processes since a moment."""

    processes: Mapping[str, psutil.Process]
    began: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        self._before = self._used()
        self.after, self.wall_s = self._before, 0.0

    def look(self) -> None:
        """Note what they have used up to now."""
        self.after, self.wall_s = self._used(), time.monotonic() - self.began

    def of_core(self) -> dict[str, float]:
        """Share of a core (%) of each."""
        wall_s = self.wall_s or math.nan
        return {name: 100.0 * (self.after[name] - self._before[name]) / wall_s
                for name in self.processes}  # fmt: skip

    def _used(self) -> dict[str, float]:
        times = {name: process.cpu_times() for name, process in self.processes.items()}
        return {name: used.user + used.system for name, used in times.items()}


def live_chain(seconds: float, logs: Path, on_progress: OnProgress) -> LiveChain:
    """Play the sample trial to both nodes, from `BEFORE_S` on in real time.

    Parameters
    ----------
    seconds
        Length of the stretch in real time.
    logs
        Takes what the nodes say.
    on_progress
        Called now and then.

    Raises
    ------
    TrawlError
        If there is no ROS 2.
    NodeFailed
        If a node ends by itself, or cannot end cleanly.
    """
    try:
        from trawl_ros.lab.running.estimate_monitor import EstimateMonitor
    except ImportError as reason:
        raise RosMissing('the nodes', reason) from reason
    bag: dict[str, Value] = {
        'bag': str(share_path('bags', BAG)),
        'publish_clock': True,
        'wait_for': [*NODES],
    }
    with (
        own_graph(logs) as environment,
        Processes(logs, environment) as processes,
        EstimateMonitor(environment) as monitor,
    ):
        for node, parameters in NODES.items():
            processes.start(node, use_sim_time=True, **parameters)
        processes.start(PLAYER, rate=0.0, end=BEFORE_S, **bag)
        while not processes.finished(PLAYER):
            time.sleep(LOOK_S)
            on_progress(WorkProgress('nodes, what comes before', monitor.windows, None, 'windows'))
        known = len(monitor.motion_delays_s())
        processes.start(PLAYER, start=BEFORE_S, end=BEFORE_S + seconds, **bag)
        pids = processes.pids()
        used = _Shares({node: psutil.Process(pids[node]) for node in NODES})
        while not processes.finished(PLAYER):
            time.sleep(LOOK_S)
            used.look()
            on_progress(WorkProgress('nodes in real time', used.wall_s, seconds, 's'))
        delays, windows = monitor.motion_delays_s()[known:], monitor.windows
        processes.stop(*NODES)
    return LiveChain(used.of_core(), tuple(delays), windows, used.wall_s)


def live_chain_rows(found: LiveChain) -> list[MeasuredValue]:
    """Share of a core of both nodes together, and delay of estimates by all of the tow."""
    delays = np.array(found.delays_s)
    there = len(delays) > 0
    each = ', '.join(f'{node} {share:.1f} %' for node, share in found.shares.items())
    return [
        MeasuredValue(
            'both nodes in real time: share of a core',
            sum(found.shares.values()), '%', at_most(MOST_OF_CORE),
            f'{each}; the gear as it ships, over {found.wall_s / 60.0:.1f} min of {BAG} behind '
            f'the first {BEFORE_S / 60.0:.0f}; {found.windows} windows at the end',
        ),
        MeasuredValue(
            'both nodes in real time: estimate by all of the tow after its half minute',
            float(delays.max()) if there else math.nan, 's', at_most(LATEST_S),
            f'the latest of {len(delays)}; least and most. Findings of the watch come 15 s later '
            'than what they are of, by design',
            low=float(delays.min()) if there else math.nan,
            high=float(delays.max()) if there else math.nan,
        ),
    ]  # fmt: skip
