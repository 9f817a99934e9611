"""Course of a tow: error-free readings over time."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.lab.trials.linearised_plant import LinearisedState
from trawl_ros.lab.trials.tows import PlannedTow

HOLD_S = 90.0
"""A state is held so long after the moment for which it is planned, so that one window or two are
found.
"""

AWAY_M = 150.0
"""Warps are so much shorter when a tow begins: before the first state nothing is steady."""

EARLY_S = 60.0
"""And reached so much earlier than it would have to be."""


@dataclass(frozen=True)
class Course:
    """Course of a tow, second by second.

    Attributes
    ----------
    times : (n,) array
        Since it began, s.
    inputs : (n, 3) array
        Both warp lengths (m) and speed (m/s) as counters and log would show them.
    values : (n, 22) array
        Observables as sensors would show them.
    heading
        ENU yaw, rad.
    moments
        Time (s) of each state.
    """

    times: FloatArray
    inputs: FloatArray
    values: FloatArray
    heading: float
    moments: tuple[float, ...]

    def at(self, times: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inputs (m, 3) and values (m, 22) at other times (m,)."""
        inputs, values = (
            np.column_stack([np.interp(times, self.times, column) for column in table.T])
            for table in (self.inputs, self.values)
        )
        return inputs, values


def settling_time(length: float, speed: float) -> float:
    """Settling time (s) before a state counts as steady."""
    options = WindowOptions()
    passages = options.settle_passages * (length + options.net_length) / speed
    return max(options.settle_s, min(passages, options.longest_settle_s))


def quasi_steady(tow: PlannedTow, looks: Sequence[LinearisedState]) -> Course:
    """Quasi-steady course: one steady state after the other, also between them."""
    length, speed = looks[0].state
    shooting = replace(looks[0], state=(length - AWAY_M, speed))
    times, rows, moments = [0.0], [shooting], []
    for place, look in enumerate(looks):
        moment = 3600.0 * tow.moment(place).hours
        moments.append(moment)
        reached = moment - EARLY_S - settling_time(*look.state)
        times += [max(reached, times[-1]), moment + HOLD_S]
        rows += [look, look]
    return Course(
        np.array(times),
        np.array([look.inputs for look in rows]),
        np.array([look.values for look in rows]),
        0.0 if tow.eastward else np.pi,
        tuple(moments),
    )
