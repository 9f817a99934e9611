# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parts of a tow between the silences of its counters, log and winches."""

from dataclasses import replace

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion.series import Series, TowReadings
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.records.channels import CHANNELS, INPUTS

NEXT_TOW_S = WindowOptions.tow_gap_s


def parts_of(read: TowReadings, shortest_s: float) -> list[TowReadings]:
    """Divide a tow where an input is silent for longer than it may be.

    Parameters
    ----------
    read
        Its readings.
    shortest_s
        Parts that last shorter (s) are left away.

    Returns
    -------
    list
        Parts long enough; the tow itself where nothing is silent.
    """
    inputs = [(read.series[name].times, CHANNELS[name].longest_gap) for name in INPUTS]
    inputs.append((read.payout[0].times, CHANNELS[INPUTS[0]].longest_gap))
    silent = []
    for times, longest in inputs:
        (places,) = np.nonzero(np.diff(times) > longest)
        silent += [(float(times[place]), float(times[place + 1])) for place in places]
    if not silent:
        return [read]
    begins = [0.0, *(end for _, end in silent)]
    ends = [*(begin for begin, _ in silent), read.duration_s]
    parts = []
    for begin in sorted(set(begins)):
        # Up to the next silence, unless this lies within one.
        end = min((other for other in ends if other > begin), default=begin)
        within = any(first <= begin < last for first, last in silent)
        if not within and end - begin >= shortest_s:
            # Behind a silence so long another tow begins, as for the windows.
            origins = [last for first, last in silent if first + NEXT_TOW_S <= last <= begin]
            parts.append(_part(read, begin, end, max(origins, default=0.0)))
    return parts


def _part(read: TowReadings, begin: float, end: float, origin: float) -> TowReadings:
    series = {name: _cut(known, begin, end) for name, known in read.series.items()}
    payout = [_cut(known, begin, end) for known in read.payout]
    start = read.start_ns + round(begin * SECOND)
    kept = {name: known for name, known in series.items() if name in INPUTS or len(known)}
    fallen = tuple(times - begin for times in read.fallen)
    return TowReadings(start, kept, (payout[0], payout[1]), (begin - origin) / 3600.0, fallen)


def _cut(series: Series, begin: float, end: float) -> Series:
    inside = (series.times >= begin) & (series.times <= end)
    return replace(series, times=series.times[inside] - begin, values=series.values[inside])
