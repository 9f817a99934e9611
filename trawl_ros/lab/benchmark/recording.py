# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Losses and cost of the recorder at the rates of all topics together."""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from trawl_ros.bags.reader import Bag
from trawl_ros.lab.benchmark.modules import without_ros
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.own_graph import own_graph
from trawl_ros.lab.running.processes import NodeFailed, Processes

RATES_HZ = (500.0, 1000.0, 5000.0)
"""Total message rates; the first one has the target."""

DURATION_S = 60.0
SMALL_SECONDS = 1.0
PATIENCE_S = 30.0
RECORDER = 'bag_recorder'


@dataclass(frozen=True)
class Recorded:
    """Recording: messages by full topic name as published and as in the bag, and its cost.

    ``behind_s`` is the wall time by which the publisher fell behind, and ``cpu_s`` the CPU time of
    the recorder, with its start.
    """

    published: Mapping[str, int]
    recorded: Mapping[str, int]
    behind_s: float
    cpu_s: float

    @property
    def lost(self) -> int:
        """Number of messages that are not in the bag."""
        return sum((Counter(self.published) - Counter(self.recorded)).values())


def record(folder: Path, rate: float, seconds: float) -> Recorded:
    """Publish all topics in one process and record them in another.

    Parameters
    ----------
    folder
        Takes the bag and what the processes say.
    rate
        Messages per second in total.
    seconds
        Duration.

    Raises
    ------
    NodeFailed
        If one of them does.
    """
    bag = folder / 'bag'
    publishing = [
        sys.executable, '-m', 'trawl_ros.lab.benchmark.full_chain', '--ros-args',
        '-p', f'rate:={rate}', '-p', f'seconds:={seconds}', '-p', f'wait_for:=[{RECORDER}]',
    ]  # fmt: skip
    with (
        own_graph(folder / 'log') as environment,
        Processes(folder / 'output', environment) as processes,
    ):
        processes.start(RECORDER, output=str(bag))
        try:
            done = subprocess.run(
                publishing,
                env={**os.environ, **environment},
                capture_output=True,
                text=True,
                timeout=seconds + PATIENCE_S,
                check=False,
            )
        except subprocess.TimeoutExpired as reason:
            processes.check()
            raise NodeFailed(f'full_chain: not done after {reason.timeout:g} s') from None
        if done.returncode:
            raise NodeFailed(f'full_chain: ended with code {done.returncode}: {done.stderr}')
        cpu_s = _cpu_s(processes.pids()[RECORDER])
        processes.stop(RECORDER)
    result = json.loads(done.stdout)
    recorded = Counter(message.topic for message in Bag(bag).as_stored())
    return Recorded(result['published'], recorded, result['behind_s'], cpu_s)


def measure(quick: bool) -> Findings:
    """Record at each rate and count."""
    what = f'messages lost at {RATES_HZ[0]:g} messages/s of all topics'
    asked = MeasuredValue(what, math.nan, target=at_most(0.0))
    if (nothing := without_ros(asked)) is not None:
        return nothing
    seconds = SMALL_SECONDS if quick else DURATION_S
    rows = []
    for rate in RATES_HZ[:1] if quick else RATES_HZ:
        with tempfile.TemporaryDirectory() as name:
            found = record(Path(name), rate, seconds)
        count = sum(found.published.values())
        note = f'of {count} on {len(found.published)} topics in {seconds:g} s'
        if found.behind_s:
            note += f'; the publisher itself fell {found.behind_s:.1f} s behind'
        rows.append(
            replace(asked, value=found.lost, note=note)
            if rate == RATES_HZ[0]
            else MeasuredValue(f'messages lost at {rate:g} messages/s', found.lost, note=note)
        )
        rows.append(
            MeasuredValue(
                f'recorder at {rate:g} messages/s, of one core',
                100.0 * found.cpu_s / seconds,
                '%',
                note='CPU time by wall time of the recording, its start included',
            )
        )
    return Findings(
        tuple(rows),
        text='One process publishes all topics of the project with messages as large as on a '
        'tow, paced, and counts; bag_recorder in another writes them with its defaults. What is '
        'in the bag is then counted against that.',
    )


def _cpu_s(pid: int) -> float:
    """CPU time (s) used by a process so far."""
    # The rest behind the name, which may have spaces, begins with the third field.
    fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    user, system = int(fields[11]), int(fields[12])
    return (user + system) / os.sysconf('SC_CLK_TCK')
