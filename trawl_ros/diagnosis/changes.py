"""Change points: a channel that jumps between two steady states and stays there."""

from itertools import pairwise

import numpy as np
from scipy.special import ndtri

from trawl_ros.diagnosis.evidence import BLIND, evidence
from trawl_ros.diagnosis.locating import Where
from trawl_ros.diagnosis.score_test import ScoreTest, blocks_of
from trawl_ros.estimation.fit.linearised import Linearised

TIME = 'time'
CHANCE = 0.01
"""Part of trials in which a jump is seen somewhere though there is none."""


def changes(seen: ScoreTest) -> tuple[Where, ...]:
    """The most telling jump of each channel, where it alone explains more than all patterns of the
    channel together; the clearest first.

    A jump after each steady state is looked for in each channel, in the order in which they were
    towed, with boards and errors of calibration taken out.
    """
    parts = seen.fit.windows
    times = sorted({_time(part) for part in parts})
    channels = list(dict.fromkeys(pattern.channel for pattern in seen.patterns))
    jumps = [(name, before, after) for name in channels for before, after in pairwise(times)]
    if not jumps:
        return ()
    columns = []
    for part in parts:
        own = np.zeros((len(part.channels), len(jumps)))
        std = part.std(1)
        for place, (name, _, after) in enumerate(jumps):
            if name in part.channels and _time(part) >= after:
                row = part.channels.index(name)
                own[row, place] = std[row]
        columns.append(own)
    found = evidence(seen.fit, columns, np.ones(len(jumps)), weights=seen.weights)
    information = np.diag(found.information)
    z = found.score / np.sqrt(np.where(information > BLIND, information, np.inf))
    least = float(-ndtri(0.5 * CHANCE / len(jumps)))
    usual = evidence(seen.fit, seen.shapes, np.ones(len(seen.patterns)), weights=seen.weights)
    together = {name: usual.chi2(block) for name, block in blocks_of(seen.patterns, 0).items()}
    located = []
    for name in channels:
        places = [place for place, jump in enumerate(jumps) if jump[0] == name]
        best = max(places, key=lambda place: abs(z[place]))
        if abs(z[best]) >= max(least, float(np.sqrt(together[name]))):
            tow, hours = jumps[best][2]
            way = 'up' if z[best] > 0.0 else 'down'
            region = f'jumps {way} in tow {tow + 1} after {hours:.1f} h'
            located.append(Where(name, TIME, region, float(z[best])))
    return tuple(sorted(located, key=lambda where: -abs(where.z)))


def _time(part: Linearised) -> tuple[int, float]:
    """Number of the tow, and hours into it."""
    return part.window.tow, round(part.window.hours, 2)
