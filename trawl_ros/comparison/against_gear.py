"""Rows and course of logs against the equilibria of a gear file as it is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.comparison.reading import Course, ReadLog, hours_of
from trawl_ros.comparison.rows import ErrorBudget, Rows
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.estimation.fit.error_terms import Scheme, in_all_channels, tow_errors
from trawl_ros.estimation.fit.linearised import Linearised, linearise, measured_inputs
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.estimation.screening import Screening
from trawl_ros.estimation.tows import numbered
from trawl_ros.estimation.window_gate import WindowGate
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import INPUTS, MEASURED
from trawl_ros.records.observables import OBSERVABLES
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
    solved, decays, notes = _solved(windows, gear, on_progress)
    if not solved:
        raise NoSteadyState('; '.join(notes))
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
        by_coefficients=None
        if gear.pair is not None
        else np.array([in_all_channels(one, one.by_coefficients) for one in solved])
        * board_prior(gear).std,
    )
    courses = tuple(_equilibria(log.course, solved, NearState()) for log in logs)
    return AgainstGear(rows, courses, tuple(notes))


def _solved(
    windows: Sequence[SteadyWindow], gear: GearRecord, on_progress: OnProgress
) -> tuple[list[Linearised], list[float], list[str]]:
    """Solve the first window of each state, and those that follow to first order from it.

    Returns the solved windows, the time (s) in which the slowest motion of each decays, and notes.
    """
    predictor = predictor_for(gear)
    coefficients = predictor.model.coefficients
    gate = WindowGate(Screening(predictor, board_prior(gear), OBSERVABLES))
    solved: list[Linearised] = []
    decays: list[float] = []
    notes: list[str] = []
    without: set[int] = set()
    for window in windows:
        if window.state in without:
            continue
        near = solved[-1] if solved else None
        if (
            near is not None
            and near.window.state == window.state
            and near.channels == tuple(name for name in MEASURED if name in window.means)
        ):
            solved.append(_moved(near, window))
            decays.append(decays[-1])
            continue
        on_progress(WorkProgress('solving', window.index, len(windows), 'steady minutes'))
        judged = gate.judge(window, coefficients)
        if judged.rejected is not None:
            notes.append(f'{judged.rejected.reason}: {judged.rejected.detail}')
        starts = (None,) if near is None else (near.state, None)
        try:
            solved.append(linearise(predictor, OBSERVABLES, window, coefficients, starts))
        except NoSteadyState as error:
            without.add(window.state)
            notes.append(f'The gear file has no equilibrium for one steady state: {error}')
        else:
            there = predictor.situated(window).gear(coefficients, solved[-1].inputs)
            decays.append(slow_mode(there, solved[-1].state).decay_s)
    return solved, decays, list(dict.fromkeys(notes))


def _errors(
    solved: Sequence[Linearised], decays: Sequence[float], courses: Sequence[Course]
) -> ErrorBudget:
    """Return the errors of the fit, with that of a gear not at rest by its drift.

    After a change the slowest motion x decays as x' = -x / T, so the rest of it is T x'.
    """
    tows = tow_errors(solved, Scheme())
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
        least = Scheme().unsettled * abs(linear.window.means[name])
        drift = course.rate(name, linear.window.end_ns)
        if shape > 0.0:
            return float(np.hypot(least, decay_s * drift) / shape)
    return 0.0


def _moved(near: Linearised, window: SteadyWindow) -> Linearised:
    """Return a linearisation at another window of the same state."""
    change = near.by_inputs @ (measured_inputs(window) - measured_inputs(near.window))
    measured = np.array([window.means[name] for name in near.channels])
    return replace(near, window=window, measured=measured, values=near.values + change)


def _equilibria(
    course: Course, solved: Sequence[Linearised], near: NearState
) -> dict[str, FloatArray]:
    """Return equilibria (n,) by channel over a course, NaN where no solved state is near."""
    states = {linear.window.state: linear for linear in solved}
    places = list(states.values())
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
