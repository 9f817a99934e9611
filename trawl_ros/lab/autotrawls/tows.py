# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tows of the bench: a scenario with a controller of the winches, and its scores."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.resources import share_path
from trawl_ros.lab.autotrawls.controllers import MakeController
from trawl_ros.scenario.run import Trial
from trawl_ros.scenario.scenario import Scenario, load_scenario
from trawl_ros.solver.equilibrium import steady_state

SCENARIOS = ('swell', 'turn', 'current_edge', 'failed_counter', 'hauling')
SCORED_FROM_S = 60.0
"""Each scenario begins with a calm minute, which is not scored."""


@dataclass(frozen=True)
class TowHistory:
    """History of a tow: ``times`` (n,) in s, and what was at them.

    Attributes
    ----------
    tensions, lengths
        Of both warps, port first, (n, 2): N, m.
    spreads, wanted_spreads
        Door spread, and that of a steady tow at the set lengths without disturbance, (n,), m.
    """

    times: FloatArray
    tensions: FloatArray
    lengths: FloatArray
    spreads: FloatArray
    wanted_spreads: FloatArray


@dataclass(frozen=True)
class Score:
    """Score of a tow, after the calm minute; less is better.

    Attributes
    ----------
    imbalance
        RMS of the difference of both tensions over their sum, %.
    tension_std
        Standard deviation of the tension of a warp over its mean, % (mean of both).
    spread_error
        RMS of the door spread's distance from that of a steady tow at the set lengths, m.
    wire_speed
        Mean speed of the wire in either direction, m/s (mean of both).
    """

    imbalance: float
    tension_std: float
    spread_error: float
    wire_speed: float


def bench_scenario(name: str) -> Scenario:
    """Load a scenario of the bench."""
    return load_scenario(share_path('config', 'bench', f'{name}.yaml'))


def tow_with(scenario: Scenario, make: MakeController) -> TowHistory:
    """Tow a scenario with a controller.

    Raises
    ------
    TrawlError
        If it does not work the winches in a way that can be computed.
    """
    if not scenario.autotrawled:
        raise TrawlError(f'{scenario.path}: no step has an autotrawl; expected one in the first')
    trial = Trial(scenario, winches=make)
    rows = []
    while (truth := trial.step()) is not None:
        both = truth.winches
        rows.append(
            (
                truth.stamp / 1e9,
                *(winch.tension for winch in both),
                *(winch.length for winch in both),
                float(np.linalg.norm(truth.doors[0].position - truth.doors[1].position)),
            )
        )
    found = np.array(rows)
    return TowHistory(
        found[:, 0],
        found[:, 1:3],
        found[:, 3:5],
        found[:, 5],
        _wanted_spreads(trial, found[:, 0]),
    )


def _wanted_spreads(trial: Trial, times: FloatArray) -> FloatArray:
    """Return the door spreads (n,), m, of undisturbed steady tows, linear between set lengths.

    Changed set lengths count as far as the winches can have come.
    """
    commands = [trial.scenario.commands_at(float(time)) for time in times]
    lengths = np.array([0.5 * (one.port_length + one.starboard_length) for one in commands])
    most = trial.scenario.plant.winch.max_speed_m_s
    for at in range(1, len(times)):
        way = most * (times[at] - times[at - 1])
        lengths[at] = lengths[at - 1] + np.clip(lengths[at] - lengths[at - 1], -way, way)
    ends = np.unique([lengths.min(), lengths.max()])
    speed = commands[0].speed
    steady = [steady_state(trial.model, float(end), speed).observables.door_spread for end in ends]
    spreads: FloatArray = np.interp(lengths, ends, steady)
    return spreads


def score(tow: TowHistory) -> Score:
    """Score a tow."""
    on = tow.times >= SCORED_FROM_S
    port, starboard = tow.tensions[on].T
    imbalance = (port - starboard) / (port + starboard)
    variation = tow.tensions[on].std(axis=0) / tow.tensions[on].mean(axis=0)
    # Creeping winches have no speed of their own in the truth, but their lengths change.
    paid_out = np.abs(np.diff(tow.lengths[on], axis=0)).sum(axis=0)
    error = tow.spreads[on] - tow.wanted_spreads[on]
    return Score(
        imbalance=100.0 * float(np.sqrt(np.mean(imbalance**2))),
        tension_std=100.0 * float(variation.mean()),
        spread_error=float(np.sqrt(np.mean(error**2))),
        wire_speed=float(paid_out.mean() / np.ptp(tow.times[on])),
    )
