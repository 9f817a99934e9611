# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison of 6-DOF boards, boards as points, and the sample trial."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, mnae, paper_values, stack
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.validation.paper.sweeps import (
    FEW_LENGTHS,
    LENGTHS,
    Sighting,
    paper_model,
    sighting,
    warp_sweep,
)
from trawl_ros.lab.validation.paper.trial import measured, trial_windows, warp_length, widest_speed
from trawl_ros.model.board_laws import EQ14
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES, Observables
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.first_guess import attitudes
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.relax import FORCE_TOLERANCE, relax, without_attitude

FORCES = ('c1', 'c2', 'c3')
"""Constants of eq. 14 that equal C_x^F, C_y^F and C_z^F if the slopes are zero."""


def point_board(model: GearModel, attack: float, slip: float) -> GearModel:
    """Return the gear with boards that are points.

    Parameters
    ----------
    attack, slip
        α and β (rad) at which their constant force coefficients are read off eq. 14.
    """
    values = EQ14(model.coefficients, np.array(attack), np.array(slip))
    constants = np.zeros(len(COEFFICIENTS))
    constants[[COEFFICIENTS.index(name) for name in FORCES]] = values[:3]
    return model.with_coefficients(constants).with_board(points=np.zeros((3, 3)))


def point_observables(
    model: GearModel, near: Equilibrium, attack: float, lean: float = 0.0
) -> Observables:
    """Observables of a gear from `point_board` at the operating point of ``near``.

    Parameters
    ----------
    near
        The gear with boards of six degrees of freedom: where the search starts.
    attack
        Attack angle of the boards, rad, inside the range of their law; it has no effect.
    lean
        Angle (rad) by which lift is tipped up; a point has none, its lift is level.

    Raises
    ------
    NoSteadyState
        If no root is found.
    """
    start = replace(near.state, board_rotations=attitudes(attack, 0.0, lean))
    state, iterations, residual = relax(
        model,
        start,
        near.tow,
        tolerance=FORCE_TOLERANCE,
        time_step=5.0,
        free=without_attitude(model),
    )
    if residual > FORCE_TOLERANCE:
        raise NoSteadyState(
            f'warp {near.point.port_length:g} m at {near.point.speed:g} m/s, boards as points: '
            f'no steady state found in {iterations} iterations, {residual:.3g} N left'
        )
    return observe(model, state, near.tow)


Seen = Callable[[Equilibrium], Observables]


@dataclass(frozen=True)
class Comparison:
    """Columns are those of eq. 35: door spread, door depth, warp tension, net depth (m, N).

    Attributes
    ----------
    speed, lengths, sightings
        The sweep with 6-DOF boards over ``n`` warp lengths (m), at the speed (m/s) at which the
        trial covers most of them.
    six, three : (n, 4) arrays
        6-DOF boards, and points with the coefficients at the sweep's mean ``attack`` and ``slip``
        (rad).
    point_lift
        C_y^F of the points.
    lean
        Mean inclination (rad) of the 6-DOF boards over the sweep.
    windows, on_line
        Steady windows of the trial, and which of them were towed at ``speed``.
    trial, trial_six, trial_three, trial_leaning : (m, 4) arrays
        Measured, and predicted at each window's mean warp length and speed; ``trial_leaning`` by
        points whose lift is tipped up by ``lean``. NaN where there is no steady state.
    """

    speed: float
    lengths: FloatArray
    sightings: tuple[Sighting, ...]
    six: FloatArray
    three: FloatArray
    attack: float
    slip: float
    point_lift: float
    lean: float
    windows: tuple[SteadyWindow, ...]
    on_line: tuple[int, ...]
    trial: FloatArray
    trial_six: FloatArray
    trial_three: FloatArray
    trial_leaning: FloatArray

    def error(self, predicted: FloatArray, channel: str) -> float:
        """Mean error over mean measured value of one channel on the trial's windows, %."""
        return 100.0 * float(mnae(predicted, self.trial)[column(channel)])


def column(channel: str) -> int:
    """Column of a quantity of eq. 35."""
    return [row.name for row in PAPER_CHANNELS].index(channel)


@cache
def compare_trial(quick: bool) -> Comparison:
    """Compare the gear of the paper with the sample trial; in a process once."""
    lengths = FEW_LENGTHS if quick else LENGTHS
    return compare(paper_model(quick), trial_windows(quick), lengths)


def compare(
    model: GearModel, windows: Sequence[SteadyWindow], lengths: Sequence[float]
) -> Comparison:
    """Solve the gear over a sweep of warp lengths and at the windows of the trial.

    The coefficients are those of ``model``: of eq. 37, as in the paper's own figures.
    """
    speed, on_line = widest_speed(windows)
    sweep = warp_sweep(model, lengths, speed)
    sightings = tuple(sighting(model, steady) for steady in sweep)
    attack, slip, lean = (
        float(np.mean([getattr(one.seen, name) for one in sightings]))
        for name in ('port_attack', 'port_slip', 'port_inclination')
    )
    points = point_board(model, attack, slip)
    at_windows: list[Equilibrium | None] = []
    for window in windows:
        length = warp_length(window)
        nearest = min(sweep, key=lambda one: abs(one.equilibrium.point.port_length - length))
        point = OperatingPoint(length, length, window.means['speed'])
        try:
            at_windows.append(find_equilibrium(model, point, nearest.equilibrium))
        except NoSteadyState:
            at_windows.append(None)

    def level(near: Equilibrium) -> Observables:
        return point_observables(points, near, attack)

    def leaning(near: Equilibrium) -> Observables:
        return point_observables(points, near, attack, lean)

    on_sweep = [steady.equilibrium for steady in sweep]
    return Comparison(
        speed=speed,
        lengths=np.array(lengths),
        sightings=sightings,
        six=_rows(on_sweep, _as_found),
        three=_rows(on_sweep, level),
        attack=attack,
        slip=slip,
        point_lift=float(points.coefficients[COEFFICIENTS.index('c2')]),
        lean=lean,
        windows=tuple(windows),
        on_line=tuple(on_line),
        trial=measured(windows),
        trial_six=_rows(at_windows, _as_found),
        trial_three=_rows(at_windows, level),
        trial_leaning=_rows(at_windows, leaning),
    )


def _as_found(near: Equilibrium) -> Observables:
    return near.observables


def _rows(states: Sequence[Equilibrium | None], see: Seen) -> FloatArray:
    """The quantities of eq. 35 for each state, NaN where there is none."""
    rows = []
    for state in states:
        try:
            if state is None:
                raise NoSteadyState('no steady state to start from')
            values = see(state).array()
        except NoSteadyState:
            rows.append(np.full(len(PAPER_CHANNELS), np.nan))
        else:
            rows.append(paper_values(dict(zip(OBSERVABLES, values, strict=True))))
    return stack(rows)
