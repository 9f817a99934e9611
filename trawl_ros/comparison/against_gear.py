# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows and course of logs against the equilibria of a gear file as it is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.comparison.reading import Course, ReadLog, hours_of
from trawl_ros.comparison.rows import ErrorBudget, Rows
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.estimation.fit.error_terms import in_all_channels, tow_errors
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.linearised import Linearised, linearise, measured_inputs
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.tows import numbered
from trawl_ros.estimation.window_gate import WindowGate
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.slow_mode import slow_mode

DEPTHS = 'net_depth', 'port_door_depth', 'starboard_door_depth'
"""Channels that show the slowest motion, the clearest first."""


@dataclass(frozen=True)
class NearState:
    """How near to a solved state a minute is compared with it, to first order.

    Attributes
    ----------
    warp
        Largest relative difference of a warp length.
    speed
        Largest relative difference of the speed.
    """

    warp: float = 0.02
    speed: float = 0.05


@dataclass(frozen=True)
class AgainstGear:
    """Rows of all logs, equilibria over the course of each log, and notes on what is not used."""

    rows: Rows
    courses: tuple[dict[str, FloatArray], ...]
    notes: tuple[str, ...]


def against_gear(logs: Sequence[ReadLog], gear: GearRecord, on_progress: OnProgress) -> AgainstGear:
    """Solve the gear at the measured warp lengths and speed of each steady state.

    Parameters
    ----------
    logs
        Logs with at least one steady minute in all.
    gear
        Gear file as it is: coefficients, effects and net are those of the file.
    on_progress
        Called for each state.

    Raises
    ------
    NoSteadyState
        If the gear has no equilibrium in any of the states.
    """
    windows, _ = numbered([log.found for log in logs])
    log_of = np.repeat(np.arange(len(logs)), [len(log.found.windows) for log in logs])
    hours = np.array([hour for log in logs for hour in hours_of(log)])
    states, notes = _solved(windows, gear, on_progress)
    if not states:
        raise NoSteadyState('; '.join(notes))
    solved = [_moved(states[one.state].linear, one) for one in windows if one.state in states]
    decays = [states[linear.window.state].decay_s for linear in solved]
    used = np.array([linear.window.index for linear in solved])
    _, state = np.unique([linear.window.state for linear in solved], return_inverse=True)
    rows = Rows(
        channels=MEASURED,
        state=state,
        log=log_of[used],
        hours=hours[used],
        inputs=np.array([measured_inputs(linear.window) for linear in solved]),
        measured=np.array([in_all_channels(one, one.measured) for one in solved]),
        reference=np.array([in_all_channels(one, one.values) for one in solved]),
        present=np.array([[name in one.channels for name in MEASURED] for one in solved]),
        errors=_errors(solved, decays, [logs[log].course for log in log_of[used]]),
        by_coefficients=np.array([in_all_channels(one, one.by_coefficients) for one in solved])
        * board_prior(gear).std,
    )
    places = [one.linear for one in states.values()]
    courses = tuple(_equilibria(log.course, places, NearState()) for log in logs)
    return AgainstGear(rows, courses, tuple(notes))


@dataclass(frozen=True)
class SolvedState:
    """Linearised equilibrium of a state with all channels, and the decay of its slowest motion."""

    linear: Linearised
    decay_s: float


def _solved(
    windows: Sequence[SteadyWindow], gear: GearRecord, on_progress: OnProgress
) -> tuple[dict[int, SolvedState], list[str]]:
    """Solve the first window of each state; return the states, and notes on what is wrong."""
    predictor = predictor_for(gear)
    coefficients = predictor.model.coefficients
    gate = WindowGate(Screening(predictor, board_prior(gear), OBSERVABLES))
    states: dict[int, SolvedState] = {}
    notes: list[str] = []
    near: Equilibrium | None = None
    first: dict[int, SteadyWindow] = {}
    for window in windows:
        first.setdefault(window.state, window)
    for window in first.values():
        on_progress(WorkProgress('solving', window.index, len(windows), 'steady minutes'))
        judged = gate.judge(window, coefficients)
        if judged.rejected is not None:
            notes.append(f'{judged.rejected.reason}: {judged.rejected.detail}')
        # A window that lacks a channel gets it too: others of its state may have it.
        whole = replace(window, means={**dict.fromkeys(MEASURED, 0.0), **window.means})
        starts = (None,) if near is None else (near, None)
        try:
            linear = linearise(predictor, OBSERVABLES, whole, coefficients, starts)
        except NoSteadyState as error:
            notes.append(f'The gear file has no equilibrium for one steady state: {error}')
            continue
        near = linear.state
        there = predictor.situated(window).gear(coefficients, linear.inputs)
        states[window.state] = SolvedState(linear, slow_mode(there, near).decay_s)
    return states, list(dict.fromkeys(notes))


def _errors(
    solved: Sequence[Linearised], decays: Sequence[float], courses: Sequence[Course]
) -> ErrorBudget:
    """Return the errors of the fit, with that of a gear not at rest by its drift.

    After a change the slowest motion x decays as x' = -x / T, so the rest of it is T x'.
    """
    tows = tow_errors(solved, EstimatorOptions())
    states = [linear.window.state for linear in solved]
    for tow in tows:
        for place, row in enumerate(tow.rows):
            # The windows of a state share this error, so their number must not wear it down.
            size = _unsettled(solved[row], decays[row], courses[row])
            shape = in_all_channels(solved[row], solved[row].slow)
            tow.inputs[place, :, -1] = size * np.sqrt(states.count(states[row])) * shape
    return ErrorBudget.of_tows(tows)


def _unsettled(linear: Linearised, decay_s: float, course: Course) -> float:
    """Return the std of the amplitude of the slowest motion, per metre of net depth."""
    depths = [name for name in DEPTHS if name in linear.channels]
    for name in depths:
        shape = abs(linear.slow[linear.channels.index(name)])
        least = EstimatorOptions().unsettled * abs(linear.window.means[name])
        drift = course.rate(name, linear.window.end_ns)
        if shape > 0.0:
            return float(np.hypot(least, decay_s * drift) / shape)
    return 0.0


def _moved(near: Linearised, window: SteadyWindow) -> Linearised:
    """Return the linearisation at a window of the same state, with its own channels."""
    rows = [row for row, name in enumerate(near.channels) if name in window.means]
    channels = tuple(near.channels[row] for row in rows)
    change = near.by_inputs @ (measured_inputs(window) - measured_inputs(near.window))
    return replace(
        near,
        window=window,
        channels=channels,
        measured=np.array([window.means[name] for name in channels]),
        values=(near.values + change)[rows],
        by_coefficients=near.by_coefficients[rows],
        by_inputs=near.by_inputs[rows],
        by_net=near.by_net[rows],
        slow=near.slow[rows],
    )


def _equilibria(
    course: Course, places: Sequence[Linearised], near: NearState
) -> dict[str, FloatArray]:
    """Return equilibria (n,) by channel over a course, NaN where no solved state is near."""
    at = np.array([measured_inputs(linear.window) for linear in places])
    missing = np.full(course.minutes, np.nan)
    inputs = np.stack([course.values.get(name, missing) for name in INPUTS], axis=1)
    away = np.abs(inputs[:, None] / at - 1.0) / (near.warp, near.warp, near.speed)
    far = np.where(np.isnan(away), np.inf, away).max(axis=2)
    nearest = far.argmin(axis=1)
    found = {name: missing.copy() for name in course.values if name in MEASURED}
    for minute in np.flatnonzero(far.min(axis=1) <= 1.0):
        linear = places[nearest[minute]]
        values = linear.values + linear.by_inputs @ (inputs[minute] - at[nearest[minute]])
        for name, value in zip(linear.channels, values, strict=True):
            if name in found:
                found[name][minute] = value
    return found
