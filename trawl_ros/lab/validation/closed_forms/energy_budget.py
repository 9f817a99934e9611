# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Energy budget of a gear that is towed and hauled: work done against energy stored."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import cumulative_trapezoid, trapezoid

from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.closed_forms.power import STORES, WORKS, Ledger
from trawl_ros.lab.validation.closed_forms.refinement import order
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.state import Tow
from trawl_ros.report.pictures import Drawing
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.stepper import HALVINGS, Motion, StepFailed, Stepper, at_rest

WARP, SPEED = 500.0, 2.1
"""Operating point at the manoeuvre's start, m and m/s."""

RATE, RAMP = 0.4, 8.0
"""Speed of hauling (m/s), and how long (s) the winches take to come up to it and to stop."""

STEADY_TOW_S = 10.0
"""Duration of the steady tow before, s."""

STEPS = (0.4, 0.2, 0.1)
USUAL = 0.2
"""Time steps, s, and the one of a simulation, for which the claim is made."""

CLAIMED = 0.005


@dataclass(frozen=True)
class WireHaul:
    """Haul: length of wire (m), and duration (s) of the whole manoeuvre."""

    wire: float
    seconds: float

    def hauled(self, t: float) -> tuple[float, float]:
        """Length hauled (m) and its rate (m/s) at a time, with cosine ramps of the rate."""
        steady = self.wire / RATE - RAMP
        up = min(max(t - STEADY_TOW_S, 0.0), RAMP)
        down = min(max(t - STEADY_TOW_S - RAMP - steady, 0.0), RAMP)
        on = min(max(t - STEADY_TOW_S - RAMP, 0.0), steady)
        wave = RAMP / np.pi

        def ramped(s: float) -> float:
            return 0.5 * RATE * (s - wave * float(np.sin(s / wave)))

        wire = ramped(up) + RATE * on + RATE * down - ramped(down)
        rate = 0.5 * RATE * (np.cos(down / wave) - np.cos(up / wave))
        return float(wire), float(rate)

    def boundary(self, tow: Tow, t: float) -> Tow:
        """Towing boundary at a time after a steady tow."""
        wire, rate = self.hauled(t)
        return replace(
            tow,
            blocks=tow.blocks + t * tow.block_velocities,
            lengths=tow.lengths - wire,
            length_rates=np.full(2, -rate),
        )


@dataclass(frozen=True)
class BudgetInstant:
    """Gear in motion at a ``time`` (s), and the towing boundary then."""

    time: float
    motion: Motion
    tow: Tow


@dataclass(frozen=True)
class Budget:
    """Energy budget of a manoeuvre.

    Attributes
    ----------
    times : (k,) array
        Ends of all steps, s; a step that was halved has more.
    works : (k, 10) array
        Work done until then, J, in the order of `WORKS`.
    stores : (k, 3) array
        Energy gained until then, J, in the order of `STORES`.
    drum
        Work of winches that take the wire in at the towing block, J.
    steps
        Number of steps, not counting halves.
    """

    times: FloatArray
    works: FloatArray
    stores: FloatArray
    drum: float
    steps: int

    @property
    def residual(self) -> FloatArray:
        """Residual of the budget, (k,) J: work done less energy gained."""
        residual: FloatArray = self.works.sum(1) - self.stores.sum(1)
        return residual

    def work(self, key: str) -> float:
        """Work of one kind over the whole manoeuvre, J."""
        return float(self.works[-1, list(WORKS).index(key)])

    @property
    def put_in(self) -> float:
        """Work of ship and winches over the whole manoeuvre, J."""
        return self.work('ship') + self.work('winches')


def budget(model: GearModel, start: Equilibrium, haul: WireHaul, h: float) -> Budget:
    """Tow and haul with steps of ``h`` seconds; powers by the trapezoid rule at every step."""
    ledger, stepper = Ledger.of(model), Stepper(model)
    path = [BudgetInstant(0.0, at_rest(start.state), start.tow)]
    steps = round(haul.seconds / h)
    for _ in range(steps):
        path.extend(advanced(stepper, path[-1], lambda t: haul.boundary(start.tow, t), h, HALVINGS))
    times = [now.time for now in path]
    energies = np.array([ledger.energies(now.motion.state, now.tow) for now in path])
    return Budget(
        times=np.array(times),
        works=cumulative_trapezoid(
            [ledger.powers(now.motion, now.tow) for now in path], times, axis=0, initial=0.0
        ),
        stores=energies - energies[0],
        drum=float(
            trapezoid([ledger.drum_power(now.motion.state, now.tow) for now in path], times)
        ),
        steps=steps,
    )


def advanced(
    stepper: Stepper, now: BudgetInstant, boundary: Callable[[float], Tow], h: float, halvings: int
) -> list[BudgetInstant]:
    """Advance by one step; a step that fails is halved, as in a simulation."""
    tow = boundary(now.time + h)
    try:
        return [BudgetInstant(now.time + h, stepper.step(now.motion, tow, h), tow)]
    except StepFailed:
        if halvings == 0:
            raise
    first = advanced(stepper, now, boundary, 0.5 * h, halvings - 1)
    return first + advanced(stepper, first[-1], boundary, 0.5 * h, halvings - 1)


def run(quick: bool) -> Findings:
    """Haul with decreasing steps."""
    gear = load_gear('kaifuha')
    if quick:
        gear = gear.changed('netting', around=12)
    haul = WireHaul(8.0, 50.0) if quick else WireHaul(50.0, 300.0)
    steps = STEPS[:2] if quick else STEPS
    model = build_model(gear)
    start = find_equilibrium(model, OperatingPoint(WARP, WARP, SPEED))
    budgets = {h: budget(model, start, haul, h) for h in steps}
    left = [float(np.abs(budgets[h].residual).max()) for h in steps]
    return Findings(
        rows=_checks(budgets[USUAL], order([round(haul.seconds / h) for h in steps], left)),
        drawings=(
            Drawing(
                'history',
                'Work done on the gear since the start, what of it the gear holds, and what is '
                'missing in the budget; the winches haul in the shaded time.',
                _drawn(budgets, haul),
            ),
        ),
        tables=(_table(budgets[USUAL]), _residuals(budgets, left)),
        text=f'The default gear is towed at {SPEED} m/s on {WARP:.0f} m of warp; {haul.wire:.0f} m '
        f'are hauled at {RATE} m/s, and the whole takes {haul.seconds:.0f} s. The model hauls by '
        'shortening all segments of a warp, so the winches work on the tension of all of them, '
        'and the wire that goes takes its energy of place and motion from all along the warp. '
        'Winches that took the wire in at the block would have done '
        f'{1e-6 * budgets[USUAL].drum:.2f} MJ by the pull there.',
    )


def _checks(found: Budget, falls: float) -> tuple[MeasuredValue, ...]:
    left = float(np.abs(found.residual).max())
    against = {
        'closes': ('all work of ship and winches', found.put_in),
        'closes_on_winches': ('the winches’ work', found.work('winches')),
        'closes_on_stores': (
            'the energy the gear gained or lost in springs, height and motion',
            float(np.abs(found.stores[-1]).sum()),
        ),
    }
    checks = [
        MeasuredValue(
            f'most that is ever missing in the budget, over {what} (steps of {USUAL} s)',
            left / abs(over),
            target=at_most(CLAIMED),
            note='Each term is a quadrature of the model’s own forces or a difference of '
            'energies; none is what the others leave.',
            key=key,
        )
        for key, (what, over) in against.items()
    ]
    checks.append(
        MeasuredValue(
            'order with which what is missing falls with the step',
            falls,
            target=at_least(1.9),
            note='It is the error of time stepper and quadrature, both of second order.',
            key='order',
        )
    )
    return tuple(checks)


def _table(found: Budget) -> TextTable:
    lines = [(words, work) for words, work in zip(WORKS.values(), found.works[-1], strict=True)]
    lines.append(('sum of work', float(found.works[-1].sum())))
    lines.extend(zip(STORES.values(), found.stores[-1], strict=True))
    lines.append(('sum of energy gained', float(found.stores[-1].sum())))
    lines.append(('missing', float(found.residual[-1])))
    winches = found.work('winches')
    return TextTable(
        f'The budget over the whole manoeuvre, steps of {USUAL} s.',
        ('', 'work or gain [kJ]', 'of ship and winches [%]', 'of the winches [%]'),
        tuple(
            (
                words,
                f'{1e-3 * work:.3f}',
                f'{100 * work / found.put_in:.4f}',
                f'{100 * work / winches:.4f}',
            )
            for words, work in lines
        ),
    )


def _residuals(budgets: dict[float, Budget], left: list[float]) -> TextTable:
    return TextTable(
        'What is missing, by step.',
        (
            'step [s]',
            'steps',
            'halved',
            'most ever [J]',
            'at the end [J]',
            'most, of the winches’ work',
        ),
        tuple(
            (
                f'{h:g}',
                str(found.steps),
                str(len(found.times) - 1 - found.steps),
                f'{most:.1f}',
                f'{found.residual[-1]:.1f}',
                f'{most / found.work("winches"):.1e}',
            )
            for (h, found), most in zip(budgets.items(), left, strict=True)
        ),
    )


def _drawn(budgets: dict[float, Budget], haul: WireHaul) -> Figure:
    figure, (above, middle, below) = panes(9.6, 8.0, 3, sharex=True)
    found = budgets[USUAL]
    works = dict(zip(WORKS, 1e-6 * found.works.T, strict=True))
    water = sum(works[key] for key in WORKS if key.endswith('_drag') or key == 'added_mass')
    above.plot(found.times, works['ship'], label='ship')
    above.plot(found.times, works['winches'], label='winches')
    above.plot(found.times, water, label='water')
    above.plot(found.times, 1e-6 * found.stores.sum(1), label='gear: springs,\nweight, motion')
    above.set(ylabel='work since the start [MJ]')
    for key, values in zip(STORES, found.stores.T, strict=True):
        middle.plot(found.times, 1e-3 * values, label=STORES[key].replace(': ', ':\n'))
    label = 'wire hauled in: its weight\nin water at its depth'
    middle.plot(found.times, 1e3 * works['wire_placed'], '--', label=label)
    middle.set(ylabel='energy since the start [kJ]')
    for h, other in budgets.items():
        below.plot(other.times, other.residual, label=f'steps of {h:g} s')
    below.set(ylabel='missing in the budget [J]', xlabel='time [s]')
    for axes in (above, middle, below):
        axes.axvspan(STEADY_TOW_S, STEADY_TOW_S + haul.wire / RATE + RAMP, color='k', alpha=0.07)
        axes.legend(loc='center left', bbox_to_anchor=(1.0, 0.5))
    return figure


CASE = ValidationCase('energy_budget', 'Energy budget over a haul', run)
