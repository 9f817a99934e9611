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


def changes(test: ScoreTest) -> tuple[Where, ...]:
    """The most telling jump of each channel, where it alone explains more than all patterns of the
    channel together; the clearest first.

    A jump after each steady state is looked for in each channel, in the order in which they were
    towed, with boards and errors of calibration taken out.
    """
    windows = test.fit.windows
    times = sorted({_time(linear) for linear in windows})
    channels = list(dict.fromkeys(pattern.channel for pattern in test.patterns))
    jumps = [(name, before, after) for name in channels for before, after in pairwise(times)]
    if not jumps:
        return ()
    columns = []
    for linear in windows:
        own = np.zeros((len(linear.channels), len(jumps)))
        std = linear.std(1)
        for place, (name, _, after) in enumerate(jumps):
            if name in linear.channels and _time(linear) >= after:
                row = linear.channels.index(name)
                own[row, place] = std[row]
        columns.append(own)
    of_jumps = evidence(test.fit, columns, np.ones(len(jumps)), weights=test.weights)
    information = np.diag(of_jumps.information)
    z = of_jumps.score / np.sqrt(np.where(information > BLIND, information, np.inf))
    least = float(-ndtri(0.5 * CHANCE / len(jumps)))
    usual = evidence(test.fit, test.shapes, np.ones(len(test.patterns)), weights=test.weights)
    together = {name: usual.chi2(block) for name, block in blocks_of(test.patterns, 0).items()}
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


def _time(linear: Linearised) -> tuple[int, float]:
    """Number of the tow, and hours into it."""
    return linear.window.tow, round(linear.window.hours, 2)
