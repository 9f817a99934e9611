# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Synthetic sample trial in the paper's form: one row of means for each steady state."""

from collections import defaultdict
from collections.abc import Sequence
from functools import cache

import numpy as np

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.resources import share_path
from trawl_ros.estimation.fit.objective import paper_values, stack
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.load import load_gear
from trawl_ros.model.water import build_water
from trawl_ros.records.topics import NAMESPACE

BAG = ('bags', 'sea_trial')
SCENARIO = ('bags', 'sea_trial.yaml')

FEWER = 4
"""The small version uses one state in this many."""


@cache
def trial_windows(quick: bool) -> tuple[SteadyWindow, ...]:
    """The first steady window of each state of the trial, in the order of time."""
    finder = SteadyWindowFinder(build_water(load_gear('kaifuha')).depth)
    found = []
    for _, sample in SampleStream([share_path(*BAG)], NAMESPACE):
        found += finder.feed(sample)
    found += finder.finish()
    first: dict[int, SteadyWindow] = {}
    for window in found:
        if isinstance(window, SteadyWindow):
            first.setdefault(window.state, window)
    windows = tuple(first.values())
    return windows[::FEWER] if quick else windows


def warp_length(window: SteadyWindow) -> float:
    """Mean length of both warps, m."""
    return 0.5 * (window.means['port_length'] + window.means['starboard_length'])


def measured(windows: Sequence[SteadyWindow]) -> FloatArray:
    """The four quantities of eq. 35, (n, 4)."""
    return stack([paper_values(window.means) for window in windows])


def widest_speed(windows: Sequence[SteadyWindow]) -> tuple[float, list[int]]:
    """Speed (m/s) with the widest range of warp lengths, and the indices of its windows."""
    groups: dict[float, list[int]] = defaultdict(list)
    for row, window in enumerate(windows):
        groups[round(window.means['speed'], 1)].append(row)

    def spanned(rows: Sequence[int]) -> float:
        lengths = [warp_length(windows[row]) for row in rows]
        return max(lengths) - min(lengths)

    rows = max(groups.values(), key=spanned)
    return float(np.mean([windows[row].means['speed'] for row in rows])), rows
