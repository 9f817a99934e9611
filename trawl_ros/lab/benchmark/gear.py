# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Speed and accuracy of the full gear through a hauling manoeuvre."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from trawl_ros.lab.benchmark.gears import default_gear
from trawl_ros.lab.benchmark.haul import (
    CONVERGED_S,
    FROM,
    TO,
    Error,
    HaulManoeuvre,
    Ride,
    error,
    haul_of,
)
from trawl_ros.lab.benchmark.web import moordyn_web_factor
from trawl_ros.lab.reference_codes.absent import PeerAbsent, PeerFailed
from trawl_ros.lab.report.measured import MeasuredValue, at_least
from trawl_ros.lab.report.page import Findings
from trawl_ros.lab.running.timing import factor_cost, median_s, timed
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.report.pictures import Drawing
from trawl_ros.simulation.simulation import Simulation
from trawl_ros.solver.stepper import StepFailed

STEPS_S = (0.1, 0.2, 0.25, 0.4, 0.5, 0.6, 0.75, 1.0, 2.0)
MAX_ERROR_SHARE = 0.01
REAL_TIME, OVER_MOORDYN = 300.0, 5.0


@dataclass(frozen=True)
class Run:
    """Run of the manoeuvre at one step size.

    ``error`` is None if a step failed. ``factor`` is the speed in times real time, and
    ``factorisations`` the mean number per step.
    """

    step_s: float
    error: Error | None
    factor: float
    factorisations: float

    @property
    def of_range(self) -> float:
        """The error as a share of the range, infinite when a step failed."""
        return math.inf if self.error is None else self.error.of_range


def measure(quick: bool) -> Findings:
    """Run the manoeuvre with one step size after another."""
    model = build_model(default_gear(quick=quick))
    haul = haul_of(model, 20.0 if quick else 300.0)
    finest = 0.25 if quick else CONVERGED_S
    ride, seconds = timed(lambda: haul.run(finest, finest))
    runs = [_run(haul, step, ride) for step in ((0.5, 1.0, 2.0) if quick else STEPS_S)]
    within = [k for k, run in enumerate(runs) if run.of_range < MAX_ERROR_SHARE]
    best = max(within, key=lambda k: runs[k].factor) if within else None
    rows = []
    if best is None:
        factor = math.nan
        limit = f'{MAX_ERROR_SHARE:.0%} of their range'
        note = f'no step of those tried keeps all observables within {limit}'
    else:
        step = runs[best].step_s
        factor = haul.duration_s / median_s(lambda: haul.run(step), 1 if quick else 3)
        note = _words(runs[best], haul)
    what = 'full gear with boards in 6-DOF, hauling, at the fastest step with an error below 1 %'
    rows.append(MeasuredValue(what, factor, '× real time', at_least(REAL_TIME), note))
    rows.append(_beside_moordyn(factor, model, quick=quick))
    if best is not None:
        rows.append(MeasuredValue('that step', runs[best].step_s, 's'))
        worst = runs[best].error
        assert worst is not None
        note = f'of the range of {worst.worst}; {worst.of_value:.2%} of its value at most'
        rows.append(MeasuredValue('its error', 100 * worst.of_range, '%', note=note))
    rows.append(_simulation(model, 4.0 if quick else 60.0))
    return Findings(
        tuple(rows),
        (Drawing('steps', 'Error and speed of the manoeuvre against the time step.', _draw(runs)),),
        text=f'{haul.duration_s:.0f} s: the winches haul from {FROM.port_length:.0f} to '
        f'{TO.port_length:.0f} m and the ship slows from {FROM.speed:g} to {TO.speed:g} m/s, '
        f'both within what they can do. Spread, depths, tensions, opening, α and δ are held '
        f'against a run in steps of {CONVERGED_S:g} s, which took {seconds:.0f} s; the error is '
        'the largest difference at any time, as a share of the range that the observable goes '
        'through. Ship and winches do the same in every run.',
    )


def _run(haul: HaulManoeuvre, step_s: float, converged: Ride) -> Run:
    try:
        ride, seconds = timed(lambda: haul.run(step_s))
    except StepFailed:
        return Run(step_s, None, math.nan, math.nan)
    return Run(
        step_s,
        error(ride, converged),
        haul.duration_s / seconds,
        ride.factorisations * step_s / haul.duration_s,
    )


def _words(run: Run, haul: HaulManoeuvre) -> str:
    model = haul.model
    each_s, _ = factor_cost(model, haul.start.state, haul.tows[0], 3)
    return (
        f'{model.nodes} nodes and {len(model.ends)} bars in steps of {run.step_s:g} s; a step '
        f'takes {1e3 * run.step_s / run.factor:.1f} ms, {run.factorisations:.1f} factorisations '
        f'of {1e3 * each_s:.1f} ms among it'
    )


def _beside_moordyn(factor: float, model: GearModel, *, quick: bool) -> MeasuredValue:
    what = "the same compared with MoorDyn's factor on a web of as many lines and points"
    try:
        theirs = moordyn_web_factor(quick)
    except (PeerAbsent, PeerFailed) as error:
        return MeasuredValue(what, math.nan, '×', at_least(OVER_MOORDYN), str(error))
    note = f'MoorDyn: {theirs:.1f} × real time, its doors prescribed'
    return MeasuredValue(what, factor / theirs, '×', at_least(OVER_MOORDYN), note)


def _simulation(model: GearModel, duration_s: float) -> MeasuredValue:
    """Row on the tow as `sim_node` and `trawl tow` advance it."""
    period_s = 0.1
    simulation = Simulation(model, FROM, period=period_s)
    # Compiling, at the first start after an installation, is left out.
    simulation.advance()
    simulation.command = TO

    def tow() -> None:
        for _ in range(round(duration_s / period_s)):
            simulation.advance()

    seconds = timed(tow)[1]
    return MeasuredValue(
        'the same hauling in the steps that sim_node takes by default',
        duration_s / seconds,
        '× real time',
        note=f'an instant every {period_s:g} s, steps of {2 * period_s:g} s; messages not '
        'counted; ran once',
    )


def _draw(runs: Sequence[Run]) -> Figure:
    figure = Figure(figsize=(9.0, 4.0), layout='constrained')
    left, right = figure.subplots(1, 2)
    good = [run for run in runs if run.error is not None]
    steps = [run.step_s for run in good]
    left.loglog(steps, [100 * run.of_range for run in good], 'o-', label='of the range')
    by_value = [100 * run.error.of_value for run in good if run.error is not None]
    left.loglog(steps, by_value, 's--', label='of the value')
    left.axhline(100 * MAX_ERROR_SHARE, color='0.5', linestyle=':', label='1 %')
    left.set(xlabel='time step [s]', ylabel='largest error of any observable [%]')
    right.plot(steps, [run.factor for run in good], 'o-', label='trawl_ros')
    right.axhline(REAL_TIME, color='0.5', linestyle=':', label='to reach')
    right.set(xlabel='time step [s]', ylabel='speed [× real time]')
    for axes in (left, right):
        axes.grid(alpha=0.3, which='both')
        axes.legend()
    return figure
