# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""States of a net in a flume tank compared with the model."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import trawl_ros
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.tank.doubts import doubted, doubts_table
from trawl_ros.lab.validation.tank.held import MODEL_SCALE, HeldNet, held, led_to
from trawl_ros.lab.validation.tank.states import TRAWL, TUNED, FlumeState, read_states
from trawl_ros.report.pictures import Drawing

GEAR = 'flume_83_112'

TABLE = (
    Path(trawl_ros.__file__).parents[2] / 'shared/data/noaa_trawlmetrics/flume_tank_2025_2026.csv'
)
"""Table of the measured states, in a folder next to the checkout."""

MEDIAN, EXPONENT = 10.0, 0.1
"""Largest median error (%) asked for, and largest difference of the exponent of tension."""

SERIES = ('67.0', '63.0', '65.0', '66.0')
"""Trials with standard bridles at 17.5 m of spread whose tensions give the exponent over speed."""

QUANTITIES = {'spread': ('m', 1.0), 'height': ('m', 1.0), 'tension': ('kN', 1e-3)}
"""Display unit of each quantity, and its number in one SI unit."""

NEAR_STATES = 3
"""Number of known states to start from if a state is not found cold."""

FLOOR_FRICTION = 0.5
"""Friction of the tank's floor, as a share of the load on it, in one row."""

BESIDES = {'lower_spread': 'between lower wing tips', 'wing_height': 'upper wing tips, height'}
"""Columns of the table that do not count, in m."""


@dataclass(frozen=True)
class Compared:
    """State with the model's net for it, or the reason why there is none."""

    state: FlumeState
    net: HeldNet | None
    refusal: str = ''

    def measured(self, quantity: str) -> float:
        """Measured value, NaN where there is none."""
        return float(getattr(self.state, quantity))

    def modelled(self, quantity: str) -> float:
        """Value of the model, NaN without a steady state."""
        return math.nan if self.net is None else float(getattr(self.net, quantity))

    def error(self, quantity: str) -> float:
        """Error (%); infinite without a steady state, NaN where nothing was measured."""
        measured = self.measured(quantity)
        if math.isnan(measured):
            return math.nan
        return math.inf if self.net is None else 100.0 * (self.modelled(quantity) / measured - 1.0)


def compared(gear: GearRecord, states: Sequence[FlumeState]) -> list[Compared]:
    """Find the net of each state: cold, or else from the most similar known states."""
    found = {}
    for number, state in enumerate(states):
        try:
            found[number] = Compared(state, held(gear, state))
        except NoSteadyState as reason:
            found[number] = Compared(state, None, str(reason))
    known = [one for one in found.values() if one.net is not None]
    for number, one in found.items():
        if one.net is None:
            found[number] = _led(gear, one, known)
    return list(found.values())


def _led(gear: GearRecord, missing: Compared, known: Sequence[Compared]) -> Compared:
    """Find a state from one of the three most similar known states."""
    state, reasons = missing.state, [missing.refusal]
    alike = [
        one for one in known if (one.state.sweeps, one.state.short) == (state.sweeps, state.short)
    ]
    alike.sort(
        key=lambda one: (
            abs(one.state.speed / state.speed - 1.0)
            + abs(one.state.pulling_points / state.pulling_points - 1.0)
        )
    )
    for one in alike[:NEAR_STATES]:
        assert one.net is not None
        try:
            return Compared(state, led_to(gear, state, one.state, one.net))
        except NoSteadyState as reason:
            reasons.append(str(reason))
    return Compared(state, None, '; '.join(reasons))


def exponent(pairs: Sequence[tuple[float, float]]) -> float:
    """Slope of tension over speed, both logarithmic; NaN of a single pair."""
    if len(pairs) < 2:
        return math.nan
    speeds, tensions = np.log(np.array(pairs).T)
    return float(np.polyfit(speeds, tensions, 1)[0])


def checks(every: Sequence[Compared]) -> tuple[MeasuredValue, ...]:
    """Checks of the case."""
    counts = [one for one in every if one.state.counts]
    errors = [abs(error) for some in _errors(counts).values() for error in some]
    series = _series(every)
    measured = exponent([(one.state.speed, one.measured('tension')) for one in series])
    modelled = exponent([(one.state.speed, one.modelled('tension')) for one in series])
    return (
        MeasuredValue(
            'median error of spread, height and tension',
            float(np.median(errors)) if errors else math.nan,
            '%',
            at_most(MEDIAN),
            f'{len(errors)} values of {len(counts)} states that count: {_by_quantity(counts)}',
            key='median_error',
        ),
        MeasuredValue(
            'exponent of tension over speed',
            modelled,
            target=within(EXPONENT, of=measured),
            note=f'trials {", ".join(one.state.trial for one in series)}',
            key='exponent',
        ),
        MeasuredValue(
            'states that have a steady state in the model',
            float(sum(one.net is not None for one in every)),
            '',
            at_least(float(len(every))),
            '; '.join(f'trial {one.state.trial}: {one.refusal}' for one in every if one.refusal),
            key='steady_states',
        ),
    )


def _errors(counts: Sequence[Compared]) -> dict[str, list[float]]:
    return {
        quantity: [one.error(quantity) for one in counts if not math.isnan(one.error(quantity))]
        for quantity in QUANTITIES
    }


def _by_quantity(counts: Sequence[Compared]) -> str:
    """Median error of each quantity, with its sign."""
    return ', '.join(
        f'{quantity} {np.median(some):+.1f} %' if some else f'{quantity} not measured'
        for quantity, some in _errors(counts).items()
    )


def _series(every: Sequence[Compared]) -> list[Compared]:
    return [one for one in every if one.state.trial in SERIES and one.net is not None]


def further_table(every: Sequence[Compared]) -> TextTable:
    """Return a table of values that explain the checks and have no target."""
    nets = [one.net for one in every if one.net is not None]
    shares = [one.net.lower_share for one in every if one.state.counts and one.net is not None]
    rubbed = exponent(
        [
            (
                one.state.speed,
                one.modelled('tension') + FLOOR_FRICTION * (one.net.floor + one.net.laid),
            )
            for one in _series(every)
            if one.net is not None
        ]
    )
    share = 100.0 * float(np.median(shares)) if shares else math.nan
    floor = min((net.floor for net in nets), default=math.nan)
    return TextTable(
        'Further figures',
        ('what', 'value', 'note'),
        (
            (
                f'exponent with friction of the floor, {FLOOR_FRICTION:g} of what it carries',
                f'{rubbed:.3f}',
                'Not in the model.',
            ),
            (
                'median share of the lower bridles in the pull of all',
                f'{share:.1f} %',
                'The tank has only the sum. In the model the longer, lower ones are nearly slack.',
            ),
            (
                'least that the floor carries of the footrope',
                f'{floor:.0f} N',
                'A negative value means that the floor would have to pull.',
            ),
        ),
    )


METHOD = (
    f'Steady states of the survey bottom trawl {TRAWL} in a flume tank, as full-scale figures, '
    f'compared with `{GEAR}`. The net is held at its pulling points, as far apart and as high '
    'above the floor as in the tank; both follow from spread of doors and bridle angle in the '
    'report of the test. Mesh counts and twines were not published and are assumed; nothing is '
    f'tuned. Trial {", ".join(TUNED)}, from which twine was once set, does not count. '
    'In no state is the footrope known to be off the ground. So the floor carries legs, lower '
    'bridles and part of the footrope, without friction, and its middle lies on the floor. '
    'The states that count were chosen beforehand: standard bridles, normal legs and an empty '
    'codend. '
    f'The net in the tank has a scale of 1:{MODEL_SCALE}. Thin twine has more drag in slow water '
    '(Choo and Casarella 1971), in the tank and in the model, except for knots and ropes.'
)


def _table(every: Sequence[Compared]) -> TextTable:
    lines = []
    for one in every:
        state = one.state
        cells = [
            state.trial,
            'counts' if state.counts else 'tuned' if state.trial in TUNED else '',
            ', '.join(
                word
                for word, there in (
                    ('sweeps', state.sweeps),
                    ('short legs', state.short),
                    ('catch', state.catch),
                )
                if there
            ),
            f'{state.speed:.2f}',
            f'{state.pulling_points:.1f}',
        ]
        for quantity, (_, size) in QUANTITIES.items():
            both = one.measured(quantity), one.modelled(quantity)
            cells += ['' if math.isnan(value) else f'{size * value:.2f}' for value in both]
        for quantity in BESIDES:
            cells += [
                '' if math.isnan(v) else f'{v:.2f}'
                for v in (one.measured(quantity), one.modelled(quantity))
            ]
        cells.append(one.refusal or f'{one.net.floor:.0f}' if one.net is not None else one.refusal)
        lines.append(tuple(cells))
    measured = [
        f'{quantity} ({unit}), {who}'
        for quantity, (unit, _) in QUANTITIES.items()
        for who in ('tank', 'model')
    ]
    measured += [f'{what} (m), {who}' for what in BESIDES.values() for who in ('tank', 'model')]
    return TextTable(
        'All states',
        (
            'trial', 'use', 'rig', 'speed (m/s)', 'pulling points apart (m)', *measured,
            'floor carries (N)',
        ),
        tuple(lines),
    )  # fmt: skip


def _figure(every: Sequence[Compared]) -> Figure:
    figure = Figure(figsize=(11.0, 3.8), layout='constrained')
    for axes, (quantity, (unit, size)) in zip(
        figure.subplots(1, len(QUANTITIES)), QUANTITIES.items(), strict=True
    ):
        ends = []
        for one in every:
            tank, model = size * one.measured(quantity), size * one.modelled(quantity)
            if math.isnan(tank) or math.isnan(model):
                continue
            ends += [tank, model]
            axes.plot(tank, model, 'o', color='C0', mfc='C0' if one.state.counts else 'none')
        if ends:
            line = np.array([0.9 * min(ends), 1.1 * max(ends)])
            axes.plot(line, line, 'k-', linewidth=0.8)
            axes.fill_between(line, 0.9 * line, 1.1 * line, color='k', alpha=0.08)
        axes.set_xlabel(f'{quantity} in the tank ({unit})')
        axes.set_ylabel(f'in the model ({unit})')
    return figure


SMALL = 3
"""States of the small version, with a coarse net."""


def run(quick: bool) -> Findings:
    """Solve all states of the table, and every doubt about assumed numbers.

    Without the table nothing is run, and a sentence says so.
    """
    if not TABLE.is_file():
        why = (
            f'{TABLE.name}: not found in shared/data next to the checkout, so nothing was compared.'
        )
        return Findings((), tables=(TextTable('Not run', ('why',), ((why,),)),), text=why)
    gear, states = load_gear(GEAR), read_states(TABLE)
    if quick:
        gear = gear.changed('netting', around=24)
        states = [state for state in states if state.trial in SERIES][:SMALL]
    every = compared(gear, states)
    doubts = [] if quick else doubted(gear, states)
    tables = [_table(every), further_table(every)]
    tables += [doubts_table(doubts, states)] if doubts else []
    drawing = Drawing('flume', 'Model over tank; open marks do not count.', _figure(every))
    return Findings(checks(every), (drawing,), tuple(tables), METHOD)


CASE = ValidationCase('flume', 'A net in a flume tank', run)
