# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Order of convergence of the time stepper, on manoeuvres with hauling."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.model.assembly import bar_tensions
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.report.pictures import Drawing
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation, tow_of
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import Stepper, at_rest

SAMPLE_S = 0.8
"""Time (s) between compared instants; a multiple of every step."""

START = Command(port_length=500.0, starboard_length=500.0, speed=2.1)

HAULING = np.array([1.0, 0.8])
"""Share of the largest speed with which the port and starboard winch haul."""

SPEED_GAIN_M_S = 0.2
"""Increase of the ship's speed during the manoeuvre, m/s."""


@dataclass(frozen=True)
class SteppedManoeuvre:
    """A manoeuvre at one time step.

    Attributes
    ----------
    step
        Time step, s.
    seen : (samples, observables) array
        Observables.
    places : (samples, nodes and boards, 3) array
        Places of all nodes and boards, m.
    tension
        Lowest tension of any bar at any sample, N.
    """

    step: float
    seen: FloatArray
    places: FloatArray
    tension: float


def smooth_tow(model: GearModel, tow: Tow, t: float, duration: float) -> Tow:
    """Towing boundary at a time of a smooth manoeuvre.

    Both winches haul at a rate of one cosine wave, from rest to their largest speed and back. The
    ship gains speed along half a cosine wave.
    """
    wave = 2 * np.pi * t / duration
    hauled = 0.5 * model.gear.winch.max_speed_m_s * HAULING
    way = 0.5 * SPEED_GAIN_M_S * (t - duration / np.pi * np.sin(0.5 * wave))
    faster = 0.5 * SPEED_GAIN_M_S * (1.0 - np.cos(0.5 * wave))
    ahead = np.array([1.0, 0.0, 0.0])
    return replace(
        tow,
        blocks=tow.blocks + t * tow.block_velocities + way * ahead,
        block_velocities=tow.block_velocities + faster * ahead,
        lengths=tow.lengths - hauled * (t - np.sin(wave) * duration / (2 * np.pi)),
        length_rates=-hauled * (1.0 - np.cos(wave)),
    )


def smooth_haul(
    model: GearModel, start: Equilibrium, step: float, duration: float
) -> SteppedManoeuvre:
    """Run the stepper through the smooth manoeuvre, from a steady state."""
    stepper, motion = Stepper(model), at_rest(start.state)
    each = round(SAMPLE_S / step)
    seen, places, tension = [], [], np.inf
    for k in range(1, round(duration / step) + 1):
        tow = smooth_tow(model, start.tow, k * step, duration)
        motion = stepper.step(motion, tow, step)
        if k % each == 0:
            seen.append(observe(model, motion.state, tow).array())
            places.append(_places(motion.state))
            tension = min(tension, float(bar_tensions(model, motion.state, tow).min()))
    return SteppedManoeuvre(step, np.array(seen), np.array(places), tension)


def winch_ramp(model: GearModel, step: float, duration: float, hauled: float) -> SteppedManoeuvre:
    """Simulate hauling ``hauled`` metres to port and fewer to starboard while the ship speeds up.

    Winches and ship accelerate as the gear file says, with abrupt starts and stops.
    """
    simulation = Simulation(model, START, period=0.5 * step)
    simulation.command = Command(
        START.port_length - hauled * HAULING[0],
        START.starboard_length - hauled * HAULING[1],
        START.speed + 0.5 * SPEED_GAIN_M_S,
    )
    each = round(2 * SAMPLE_S / step)
    seen, places, tension = [], [], np.inf
    for k in range(1, round(2 * duration / step) + 1):
        now = simulation.advance()
        if k % each == 0:
            tow = tow_of(model, now.ship, now.winches)
            seen.append(observe(model, now.motion.state, tow).array())
            places.append(_places(now.motion.state))
            tension = min(tension, float(bar_tensions(model, now.motion.state, tow).min()))
    return SteppedManoeuvre(step, np.array(seen), np.array(places), tension)


def _places(state: State) -> FloatArray:
    return np.concatenate([state.nodes, state.board_positions])


MIN_SECOND_ORDER = 1.9
"""Smallest order that counts as second order: halving the step leaves 27 % of the error."""

DEFAULT_STEP = 0.2
"""Step (s) of a tow at the simulation's default period."""


SLACK_TENSION_N = 10.0
"""Tension (N) below which a bar of netting counts as slack."""

TAUT_TENSION_N = 1.0
"""Lowest tension (N) of a net that counts as taut throughout."""

BOWING_PRESSURE_PA = 317.0
"""Load (Pa) under which twine bows in the gear of which nothing goes slack: that of water on meshes
towed at 2.1 m/s with bars at 20° to the flow."""


@dataclass(frozen=True)
class ManoeuvreSize:
    """Durations (s) of both manoeuvres, steps (s), the finest for reference, and metres hauled."""

    smooth_duration: float
    smooth_steps: Sequence[float]
    ramp_duration: float
    ramp_steps: Sequence[float]
    hauled: float


FULL = ManoeuvreSize(32.0, (0.8, 0.4, 0.2, 0.1, 0.0125), 64.0, (0.4, 0.2, 0.1, 0.0125), 16.0)
SMALL = ManoeuvreSize(16.0, (0.4, 0.2, 0.1, 0.025), 12.0, (0.4, 0.2, 0.1, 0.025), 2.0)


@dataclass(frozen=True)
class Convergence:
    """Errors of coarser steps against the finest.

    ``errors`` (steps, observables) is the largest during the manoeuvre, as a share of how much
    the observable changes in it; ``places`` (steps, points) that of nodes and boards, m;
    ``tension`` the lowest of any bar in any run, N.
    """

    steps: FloatArray
    errors: FloatArray
    places: FloatArray
    tension: float

    @property
    def norm(self) -> FloatArray:
        """Root mean square (steps,) of all observables' errors."""
        norm: FloatArray = np.sqrt((self.errors**2).mean(1))
        return norm

    def order(self, errors: FloatArray) -> float:
        """Return the slope of errors (steps,) over the step, both logarithmic."""
        return float(np.polyfit(np.log(self.steps), np.log(errors), 1)[0])

    def orders(self) -> FloatArray:
        """Order (observables,) of each observable."""
        return np.array([self.order(column) for column in self.errors.T])

    def place_orders(self) -> FloatArray:
        """Order (points,) of the place of each node and board."""
        return np.array([self.order(column) for column in self.places.T])


def convergence(runs: Sequence[SteppedManoeuvre]) -> Convergence:
    """Compare runs of one manoeuvre; the last has the finest step."""
    *coarse, fine = runs
    change = np.ptp(fine.seen, axis=0)
    return Convergence(
        steps=np.array([run.step for run in coarse]),
        errors=np.array([np.abs(run.seen - fine.seen).max(0) / change for run in coarse]),
        places=np.array([np.abs(run.places - fine.places).max((0, 2)) for run in coarse]),
        tension=min(run.tension for run in runs),
    )


def run(quick: bool) -> Findings:
    """Run both manoeuvres at several steps."""
    size = SMALL if quick else FULL
    gear = load_gear('kaifuha')
    if quick:
        gear = gear.changed('netting', around=24)
    bowed = gear.changed('netting', bowing_pressure_pa=BOWING_PRESSURE_PA)
    taut = _smooth(build_model(bowed), size)
    model = build_model(gear)
    smooth = _smooth(model, size)
    ramp = convergence(
        [winch_ramp(model, step, size.ramp_duration, size.hauled) for step in size.ramp_steps]
    )
    at_default = ramp.errors[list(ramp.steps).index(DEFAULT_STEP)]
    worst = int(at_default.argmax())
    return Findings(
        rows=(
            *_taut_rows(taut),
            MeasuredValue(
                'order in the root mean square of all observables, smooth inputs',
                smooth.order(smooth.norm),
                target=at_least(MIN_SECOND_ORDER),
                note=f'With bowed twine, of which nothing goes slack, it is '
                f'{taut.order(taut.norm):.2f}. Here bars of netting go slack and taut, and their '
                'force bends within a short extension.',
                key='smooth_norm',
            ),
            MeasuredValue(
                'order in the median place of all nodes and boards, smooth inputs',
                smooth.order(np.median(smooth.places, 1)),
                target=at_least(MIN_SECOND_ORDER),
                key='smooth_median_place',
            ),
            MeasuredValue(
                'order in the root mean square of all observables, winch ramp',
                ramp.order(ramp.norm),
                target=at_least(MIN_SECOND_ORDER),
                note='Ship and winches accelerate abruptly: the second derivative of what they '
                'impose jumps, and a single observable need not show the order.',
                key='ramp_norm',
            ),
            MeasuredValue(
                'largest error of an observable at the default step, winch ramp, as a share of '
                'its change',
                100.0 * float(at_default[worst]),
                '%',
                at_most(1.0),
                f'It is that of {OBSERVABLES[worst]}, at {DEFAULT_STEP:g} s.',
                key='ramp_default_step',
            ),
        ),
        drawings=(
            Drawing(
                'order',
                'Largest error of each observable during the manoeuvre over the time step, as a '
                'share of how much it changes.',
                _figure(smooth, ramp),
            ),
        ),
        tables=(_table(taut, smooth, ramp),),
        text=(
            f'The default gear at {START.port_length:g} m and {START.speed:g} m/s hauls, more to '
            'port than to starboard, while the ship gains speed; the same manoeuvre is computed '
            f'at several steps and held against one of {size.smooth_steps[-1]:g} s. The order of '
            'a method shows only where its inputs have as many derivatives, so the winches haul '
            'with one wave of a cosine, up to their largest speed. It is towed by a gear of which '
            f'nothing goes slack, since its twine bows under {BOWING_PRESSURE_PA:g} Pa and so '
            'pulls however close its ends come, and by the default gear, some of whose netting '
            "hangs slack. The second manoeuvre is the simulation's own: acceleration sets in and "
            'ends abruptly. '
            'With the default gear the lowest order among all observables is '
            f'{smooth.orders().min():.2f}, and that of the largest error of all places '
            f'{smooth.order(smooth.places.max(1)):.2f}. {_flapping(model, smooth)}'
        ),
    )


def _smooth(model: GearModel, size: ManoeuvreSize) -> Convergence:
    point = OperatingPoint(START.port_length, START.starboard_length, START.speed)
    start = find_equilibrium(model, point)
    return convergence(
        [smooth_haul(model, start, step, size.smooth_duration) for step in size.smooth_steps]
    )


def _taut_rows(taut: Convergence) -> Iterator[MeasuredValue]:
    """Rows on the orders of a gear without slack bars, and on its lowest tension."""
    yield MeasuredValue(
        'lowest tension of any bar at any time, smooth inputs, bowed twine',
        taut.tension,
        'N',
        at_least(TAUT_TENSION_N),
        'Nothing goes slack.',
        key='taut_tension',
    )
    orders = taut.orders()
    yield MeasuredValue(
        'lowest order among all observables, smooth inputs, nothing slack',
        float(orders.min()),
        target=at_least(MIN_SECOND_ORDER),
        note=f'It is that of {OBSERVABLES[int(orders.argmin())]}. The method, generalised-α, is of '
        'second order.',
        key='taut_every_observable',
    )
    yield MeasuredValue(
        'lowest order among the places of all nodes and boards, smooth inputs, nothing slack',
        float(taut.place_orders().min()),
        target=at_least(MIN_SECOND_ORDER),
        note=f'Each of {taut.places.shape[1]} on its own.',
        key='taut_every_place',
    )


def _flapping(model: GearModel, found: Convergence) -> str:
    """Return a sentence on the point with the largest error at the shortest step."""
    worst = int(found.places[-1].argmax())
    if worst >= model.nodes:
        return 'The largest error is that of a board.'
    start = find_equilibrium(
        model, OperatingPoint(START.port_length, START.starboard_length, START.speed)
    )
    tensions = bar_tensions(model, start.state, start.tow)
    held = tensions[(model.ends == worst).any(axis=1)]
    part = 'a node of the net' if worst in model.layout.net else 'a node of a rope'
    share = float(np.median(found.places[-1]) / found.places[-1, worst])
    return (
        f'The largest error at {found.steps[-1]:g} s is that of {part}, of whose {len(held)} bars '
        f'{int((held < SLACK_TENSION_N).sum())} pull with less than {SLACK_TENSION_N:.0f} N; the '
        f'median of all points errs by {share:.2g} times as much. Slack netting flaps, and bars '
        'that jerk taut have no smooth motion for a higher order to show on.'
    )


def _table(taut: Convergence, smooth: Convergence, ramp: Convergence) -> TextTable:
    at_default = ramp.errors[list(ramp.steps).index(DEFAULT_STEP)]
    orders = np.stack([taut.orders(), smooth.orders(), ramp.orders()], axis=1)
    head = (
        'observable', 'order, smooth, nothing slack', 'order, smooth', 'order, ramp',
        f'error at {DEFAULT_STEP:g} s, ramp (%)',
    )  # fmt: skip
    return TextTable(
        'Observed orders, and the error at the default step',
        head,
        tuple(
            (name, *(f'{order:.2f}' for order in row), f'{error:.3f}')
            for name, row, error in zip(OBSERVABLES, orders, 100.0 * at_default, strict=True)
        ),
    )


def _figure(smooth: Convergence, ramp: Convergence) -> Figure:
    figure, (left, right) = panes(10.0, 4.6, 1, 2, sharey=True)
    _draw(left, smooth, 'smooth hauling')
    _draw(right, ramp, 'winch ramp')
    left.set_ylabel('largest error, share of the change (%)')
    left.legend(loc='lower right')
    return figure


def _draw(axes: Axes, found: Convergence, title: str) -> None:
    for k, errors in enumerate(found.errors.T):
        label = 'each observable' if k == 0 else None
        axes.loglog(found.steps, 100 * errors, '.-', color='0.7', linewidth=0.8, label=label)
    axes.loglog(found.steps, 100 * found.norm, 'o-', color='C0', label='root mean square')
    slope = found.norm[-1] * (found.steps / found.steps[-1]) ** 2
    axes.loglog(found.steps, 100 * slope, 'k--', linewidth=1.0, label='second order')
    axes.set_xticks(found.steps, [f'{step:g}' for step in found.steps])
    axes.minorticks_off()
    axes.set(xlabel='time step (s)', title=title)


CASE = ValidationCase('time_step', 'The time stepper is of second order', run)
