# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Start-up time of the nodes to their first message, the share of imports, and memory."""

import math
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median

import psutil

from trawl_ros.core.resources import share_path
from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.modules import without_ros
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.chain import MEGABYTE
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import Processes, Value
from trawl_ros.lab.running.timing import bytecode_kept, median_s
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state

LIMIT_S, LIMIT_MB = 2.0, 120.0
PATIENCE_S = 15.0
REPEATS = 5
HEAVIEST = 4
"""Number of packages named that take longest to import."""


@dataclass(frozen=True)
class Start:
    """Node to start, with the topic of its first message.

    ``needs_truth`` is true if the node publishes nothing without a running simulation.
    """

    node: str
    topic: str
    parameters: Mapping[str, Value] = field(default_factory=dict)
    needs_truth: bool = False


@dataclass(frozen=True)
class Begun:
    """Wall-clock time (s) to the first message of a node, and its resident memory (MB) then.

    Without a message the time is infinite and the memory NaN.
    """

    seconds: float
    memory_mb: float


TOW = Start('sim_node', 'truth/winch')


def starts(folder: Path) -> tuple[Start, ...]:
    """Return the starts of all nodes; nodes without a topic of their own report on /diagnostics."""
    return (
        Start('bag_recorder', '/diagnostics', {'output': str(folder / 'bag')}),
        Start('identification_node', '/diagnostics'),
        Start('discrepancy_node', '/diagnostics'),
        Start('bag_player', 'winch/joint_states', {'bag': str(share_path('bags', 'sea_trial'))}),
        TOW,
        Start('winch_node', 'winch/joint_states', needs_truth=True),
        Start('door_sensor_node', 'door/port/pressure', needs_truth=True),
        Start('trawl_sonar_node', 'sonar/pressure', needs_truth=True),
        Start('vessel_node', 'vessel/heading', needs_truth=True),
    )


def measure(quick: bool) -> Findings:
    """Start one node after another and wait for its first message."""
    what = 'cold start of a node to its first message, wall, the slowest node'
    asked = MeasuredValue(what, math.nan, 's', at_most(LIMIT_S))
    if (nothing := without_ros(asked)) is not None:
        return nothing
    with (
        tempfile.TemporaryDirectory() as name,
        own_graph(Path(name) / 'log') as graph,
        _environment(graph),
        bytecode_kept(),
    ):
        folder = Path(name)
        chosen = starts(folder)[:1] if quick else starts(folder)
        begun = {
            start.node: _begun(start, folder, graph, 1 if quick else REPEATS) for start in chosen
        }
    times = {node: [one.seconds for one in starts] for node, starts in begun.items()}
    slowest = max(times, key=lambda node: median(times[node]))
    node = 'bag_recorder' if quick else 'sim_node'
    with bytecode_kept(f'trawl_ros.nodes.{node}'):
        imports = import_s(f'trawl_ros.nodes.{node}')
    total = sum(imports.values())
    heaviest = ', '.join(
        f'{name} {imports[name]:.2f} s'
        for name in sorted(imports, key=imports.__getitem__, reverse=True)[:HEAVIEST]
    )
    note = (
        f'{slowest}, {min(times[slowest]):.2f} to {max(times[slowest]):.2f} s '
        f'in {len(times[slowest])} starts'
    )
    rows = [replace(asked, value=median(times[slowest]), note=note)]
    for node, found in times.items():
        note = f'{min(found):.2f} to {max(found):.2f} s in {len(found)} starts'
        rows.append(MeasuredValue(f'{node}, wall', median(found), 's', note=note))
    rows += _memory_rows(begun, {start.node for start in chosen if start.needs_truth})
    rows.append(MeasuredValue('of it, imports, wall', total, 's', note=heaviest))
    if not quick:
        model = build_model(default_gear(quick=False))
        seconds = median_s(lambda: steady_state(model, 500.0, 2.0), 3)
        rows.append(
            MeasuredValue(
                'of it, in sim_node, the first steady state', seconds, 's', note='stability checked'
            )
        )
    return Findings(
        tuple(rows),
        text='A process is started as a user does it, and its first message arrives at a '
        'subscriber that runs already: sim_node its truth, instruments a sample while a '
        'simulation runs, bag_player what it replays, and the others, which wait for data, '
        'their diagnostics, the first of which come as soon as somebody listens. Discovery by the '
        "middleware is part of it. Files are in the system's cache, and so is compiled code, that "
        'of Python too.',
    )


def _memory_rows(
    begun: Mapping[str, Sequence[Begun]], instruments: Set[str]
) -> list[MeasuredValue]:
    """Rows on the memory of each node; the instruments' largest has the target."""
    memory = {node: median(one.memory_mb for one in starts) for node, starts in begun.items()}
    rows = []
    if instruments:
        worst = max(instruments, key=memory.__getitem__)
        rows.append(
            MeasuredValue(
                'memory of an instrument node, the largest',
                memory[worst],
                'MB',
                at_most(LIMIT_MB),
                f'{worst}; resident, shared libraries included, at its first message',
            )
        )
    return rows + [
        MeasuredValue(f'{node}, memory', value, 'MB')
        for node, value in memory.items()
        if node not in instruments
    ]


def _begun(start: Start, folder: Path, environment: Mapping[str, str], repeats: int) -> list[Begun]:
    domain = int(environment['ROS_DOMAIN_ID'])
    found = []
    for _ in range(repeats):
        with Processes(folder / 'output', environment) as processes:
            if start.needs_truth:
                _first(processes, TOW, domain)
            found.append(_first(processes, start, domain))
        _forget(folder)
    return found


def _forget(folder: Path) -> None:
    """Rename the bag of a recorder, since the next recorder needs a new path."""
    bag = folder / 'bag'
    if bag.exists():
        bag.rename(folder / f'bag_{time.monotonic_ns()}')


def _first(processes: Processes, start: Start, domain: int) -> Begun:
    """Start a node and wait for its first message, at most `PATIENCE_S`.

    Raises
    ------
    NodeFailed
        If the node ends.
    """
    # Imported here, for it needs ROS 2, which reads the environment when it starts.
    from trawl_ros.lab.running.first_message import FirstMessage

    with FirstMessage(domain, start.node, start.topic) as first:
        began = time.perf_counter()
        processes.start(start.node, **start.parameters)
        while (at := first.spin(0.01)) is None:
            processes.check()
            if time.perf_counter() - began > PATIENCE_S:
                return Begun(math.inf, math.nan)
        memory = psutil.Process(processes.pids()[start.node]).memory_info().rss
        return Begun(at - began, memory / MEGABYTE)


def import_s(module: str) -> dict[str, float]:
    """Wall-clock time (s) that the import of a module takes in a new process, by package."""
    command = [sys.executable, '-X', 'importtime', '-c', f'import {module}']
    report = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    found: defaultdict[str, float] = defaultdict(float)
    for line in report.splitlines():
        own, _, rest = line.removeprefix('import time:').partition('|')
        if own.strip().isdigit():
            package = rest.partition('|')[2].strip().partition('.')[0]
            found[package] += int(own) / 1e6
    return found


@contextmanager
def _environment(wanted: Mapping[str, str]) -> Iterator[None]:
    """Set variables of this process's environment, and restore them afterwards."""
    before = {key: os.environ.get(key) for key in wanted}
    os.environ.update(wanted)
    try:
        yield
    finally:
        for key, value in before.items():
            if value is None:
                del os.environ[key]
            else:
                os.environ[key] = value
