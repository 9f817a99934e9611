"""Computing cost of the identification: a bag replayed at once, and the node in real time."""

import os
import resource
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.core.time import SECOND
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.nodes.playback.replay import Excerpt

if TYPE_CHECKING:
    from studies.live_nodes import LiveNodes

REPLAY_S = 3600.0
LEAST_RATIO, LEAST_IN_MOTION = 200.0, 30.0
"""Times real time of the replay: of steady windows alone, and of all of the tow."""

LIVE_S = 990.0
"""So much of the sample trial is played in real time: its first two steady states."""

LATEST_S = 1.0
MOST_OF_CORE = 20.0

BAG = 'sea_trial'

NODE = 'identification_node'

IDENTIFY = 'import sys; from trawl_ros.cli.main import main; sys.exit(main())'


@dataclass(frozen=True)
class Replay:
    """Cost of a replay: recorded time, processor time and wall time, s."""

    recorded_s: float
    cpu_s: float
    wall_s: float


def replay(seconds: float = REPLAY_S, *, motion: bool = False) -> Replay:
    """Run ``trawl identify`` on the beginning of the sample trial, as one process.

    Parameters
    ----------
    seconds
        Length of that beginning.
    motion
        True if all of the tow is learned from, else its steady windows alone.

    Raises
    ------
    TrawlError
        If it fails.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        recorded_s = _cut(share_path('bags', BAG), folder / 'bag', seconds)
        before, began = _children_s(), time.monotonic()
        done = subprocess.run(
            [
                sys.executable, '-c', IDENTIFY, 'identify', str(folder / 'bag'),
                '--out', str(folder / 'out'), '--motion' if motion else '--steady',
            ],
            capture_output=True,
            text=True,
            check=False,
            env={**os.environ, 'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1'},
        )  # fmt: skip
        found = Replay(recorded_s, _children_s() - before, time.monotonic() - began)
    if done.returncode:
        raise TrawlError(f'trawl identify ended with code {done.returncode}: {done.stderr}')
    return found


def replay_rows(steady: Replay, motion: Replay) -> list[MeasuredValue]:
    """Speed of replays over real time on one core: by steady windows, and by all of the tow."""
    each = (
        ('trawl identify --steady', steady, LEAST_RATIO),
        ('trawl identify, all of the tow', motion, LEAST_IN_MOTION),
    )
    return [
        MeasuredValue(
            f'replay through {what}',
            found.recorded_s / found.cpu_s,
            'times real time',
            at_least(least),
            f'{found.recorded_s / 60.0:.0f} min of the sample trial by {found.cpu_s:.1f} s of '
            f'processor time ({found.wall_s:.1f} s of wall time): start, reading, windows, fit, '
            'tows left out, figures and page',
        )
        for what, found, least in each
    ]


def live_rows(found: 'LiveNodes') -> list[MeasuredValue]:
    """Delay of estimates, and the node's share of a core."""
    # It needs ROS 2, which the other figures do without.
    from studies.live_nodes import delay_row, share_row

    return [
        delay_row(
            "node in real time: estimate after its window's end",
            found.delays_s,
            LATEST_S,
            ' windows',
        ),
        share_row(
            'node in real time: share of a core',
            found,
            MOST_OF_CORE,
            f'mean over {found.wall_s / 60.0:.1f} min of the sample trial',
        ),
    ]


def _cut(path: Path, into: Path, seconds: float) -> float:
    """Write the beginning of a bag; return its length, s."""
    bag = Bag(path)
    excerpt = Excerpt(bag, bag.topics, 0.0, seconds)
    first = last = None
    with BagWriter(into) as writer:
        while (message := excerpt.upcoming) is not None:
            writer.write(
                message.topic,
                message.type,
                message.data,
                message.log_time,
                message.publish_time,
            )
            first = message.log_time if first is None else first
            last = message.log_time
            excerpt.advance()
    return ((last or 0) - (first or 0)) / SECOND


def _children_s() -> float:
    """Processor time (s) of all processes that were started and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
