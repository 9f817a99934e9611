"""Instrument chain as processes, monitored while it runs."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING

import psutil

from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.lab.running.processes import Processes, Value

if TYPE_CHECKING:
    from trawl_ros.lab.running.delay_monitor import DelayMonitor

RECORDER, SIMULATION = 'bag_recorder', 'sim_node'
INSTRUMENTS = ('winch_node', 'door_sensor_node', 'trawl_sonar_node', 'vessel_node')
CONSUMERS = (RECORDER, *INSTRUMENTS)
CHAIN = (SIMULATION, *CONSUMERS)

LOOK_S = 0.2
BAG_PART_S = 600.0
"""Data time after which the recorder begins a new file: the index of a day in one is large."""

MEGABYTE = 1e6


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


def chain_parameters(
    node: str, scenario: Path, bag: Path, consumers: Sequence[str] = CONSUMERS
) -> dict[str, Value]:
    """Parameters of a node of the chain: as fast as it goes, with truth waiting for consumers."""
    if node == RECORDER:
        return {'use_sim_time': True, 'output': str(bag)}
    if node == SIMULATION:
        return {
            'scenario': str(scenario),
            'time_scale': 0.0,
            'publish_clock': True,
            'wait_for': list(consumers),
        }
    return {'use_sim_time': True, 'scenario': str(scenario), 'wait_for': [RECORDER]}


def start_chain(
    processes: Processes,
    scenario: Path,
    bag: Path,
    time_scale: float = 0.0,
    bag_part_s: float | None = None,
) -> None:
    """Start all nodes of the chain on a scenario; the simulation ends with it.

    Parameters
    ----------
    processes
        Runs the nodes.
    scenario, bag
        Of the tow.
    time_scale
        Speed over real time; 0 is as fast as the consumers follow.
    bag_part_s
        Data time after which the recorder begins a new file.
    """
    parts = {} if bag_part_s is None else {'max_bag_duration': bag_part_s}
    more: dict[str, dict[str, Value]] = {
        RECORDER: {**parts},
        SIMULATION: {'time_scale': time_scale, 'exit_at_end': True},
    }
    for node in (*CONSUMERS, SIMULATION):
        processes.start(node, **{**chain_parameters(node, scenario, bag), **more.get(node, {})})


def stop_chain(processes: Processes) -> None:
    """Stop all nodes of the chain that run, sources before the recorder: it gets their last words.

    Raises
    ------
    NodeFailed
        If one cannot end cleanly.
    """
    left = processes.pids()
    for group in ((SIMULATION,), INSTRUMENTS, (RECORDER,)):
        processes.stop(*(node for node in group if node in left))


def watch_chain(
    processes: Processes,
    monitor: 'DelayMonitor',
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
