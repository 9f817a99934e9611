"""States of a net in a flume tank beside the model, and their report."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, ignore, step_counter
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, within
from trawl_ros.lab.report.page import Page, Section, TextTable, write_page
from trawl_ros.lab.studies.flume.doubts import doubted, doubts_table
from trawl_ros.lab.studies.flume.held import SCALE, HeldNet, held, led_to
from trawl_ros.lab.studies.flume.states import TRAWL, TUNED, FlumeState
from trawl_ros.report.pictures import Drawing

REPORT = 'flume.md'
GEAR = 'flume_83_112'

MEDIAN, EXPONENT = 10.0, 0.1
"""Largest median error (%) asked for, and largest difference of the exponent of tension."""

SERIES = ('67.0', '63.0', '65.0', '66.0')
"""Trials with standard bridles at 17.5 m of spread whose tensions give the exponent over speed."""

QUANTITIES = {'spread': ('m', 1.0), 'height': ('m', 1.0), 'tension': ('kN', 1e-3)}
"""Unit in a report, and its number in one of SI."""

NEIGHBOURS = 3
"""States from which a net is led to one that is not found cold."""

FRICTION = 0.5
"""Friction of the tank's floor, as a share of what it carries, of which one row is made."""

BESIDES = {'lower_spread': 'between lower wing tips', 'wing_height': 'upper wing tips, height'}
"""Columns of the table of which nothing counts, in m."""


@dataclass(frozen=True)
class Compared:
    """State with the net that the model has for it, or the reason why there is none."""

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


def compared(
    gear: GearRecord, states: Sequence[FlumeState], on_progress: OnProgress = ignore
) -> list[Compared]:
    """Find the net of each state: cold, and where that fails led from those most like it."""
    done = step_counter('solving', len(states), on_progress)
    found = {}
    for number, state in enumerate(states):
        try:
            found[number] = Compared(state, held(gear, state))
        except NoSteadyState as reason:
            found[number] = Compared(state, None, str(reason))
        done()
    known = [one for one in found.values() if one.net is not None]
    for number, one in found.items():
        if one.net is None:
            found[number] = _led(gear, one, known)
    return list(found.values())


def _led(gear: GearRecord, missing: Compared, known: Sequence[Compared]) -> Compared:
    """State that was not found cold, led from one of the three most like it."""
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
    for one in alike[:NEIGHBOURS]:
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


def rows_of(every: Sequence[Compared]) -> list[MeasuredValue]:
    """Rows of the report."""
    counts = [one for one in every if one.state.counts]
    errors = {
        quantity: [one.error(quantity) for one in counts if not math.isnan(one.error(quantity))]
        for quantity in QUANTITIES
    }
    together = [abs(error) for some in errors.values() for error in some]
    rows = [
        MeasuredValue(
            'median error of spread, height and tension',
            float(np.median(together)) if together else math.nan,
            '%',
            at_most(MEDIAN),
            f'{len(together)} values of {len(counts)} states that count',
        )
    ]
    for quantity, some in errors.items():
        rows.append(
            MeasuredValue(
                f'median error of {quantity}',
                float(np.median(np.abs(some))) if some else math.nan,
                '%',
                note=f'{len(some)} values; median with its sign {np.median(some):+.1f} %'
                if some
                else 'none was measured',
            )
        )
    series = [one for one in every if one.state.trial in SERIES and one.net is not None]
    measured = exponent([(one.state.speed, one.measured('tension')) for one in series])
    ours = exponent([(one.state.speed, one.modelled('tension')) for one in series])
    rows.append(
        MeasuredValue(
            'exponent of tension over speed',
            ours,
            target=within(EXPONENT, of=measured),
            note=f'trials {", ".join(one.state.trial for one in series)}',
        )
    )
    rubbed = [
        (one.state.speed, one.modelled('tension') + FRICTION * (one.net.floor + one.net.laid))
        for one in series
        if one.net is not None
    ]
    rows.append(
        MeasuredValue(
            f'exponent with friction of the floor, {FRICTION:g} of what it carries',
            exponent(rubbed),
            note='Not in the model.',
        )
    )
    rows.append(
        MeasuredValue(
            'states that have a steady state in the model',
            float(sum(one.net is not None for one in every)),
            '',
            at_least(float(len(every))),
            '; '.join(f'trial {one.state.trial}: {one.refusal}' for one in every if one.refusal),
        )
    )
    shares = [one.net.lower_share for one in counts if one.net is not None]
    rows.append(
        MeasuredValue(
            'median share of the lower bridles in the pull of all',
            100.0 * float(np.median(shares)) if shares else math.nan,
            '%',
            note='The tank has only the sum. The lower, longer ones are nearly slack in the model.',
        )
    )
    floor = [one.net.floor for one in every if one.net is not None]
    rows.append(
        MeasuredValue(
            'least that the floor carries of the footrope',
            min(floor, default=math.nan),
            'N',
            note='Where it is negative the floor would have to pull.',
        )
    )
    return rows


def write_flume(
    folder: Path,
    every: Sequence[Compared],
    rows: Sequence[MeasuredValue],
    doubts: Sequence[TextTable] = (),
) -> list[MeasuredValue]:
    """Write ``flume.json``, ``.md``, ``.html`` and ``.png``."""
    page = Page(
        name='flume',
        title='A net in a flume tank',
        command='trawl study flume --table FILE',
        method=(
            f'Steady states of the survey bottom trawl {TRAWL} in a flume tank, as full-scale '
            f'figures, beside `{GEAR}`, held by its pulling points as far apart and as high above '
            'the floor as they were. The legs of the doors were not in the tank, as the report of '
            'the test says; it worked the spread of doors out from the bridle angle, and from both '
            'the pulling points are found again. Counts of its meshes and its twines were '
            'published nowhere and are assumed; nothing is tuned. Trial '
            f'{", ".join(TUNED)}, by which twine was once set, does not count. '
            'In no state at hand is the footrope known to be off the ground: the floor carries '
            'legs and lower bridles, and so much of the footrope that its middle lies on it, '
            'without friction. What counts was chosen before anything was solved with the gear '
            'as it ships: states with standard bridles, normal legs and an empty codend. '
            f'The tank has a net 1:{SCALE} in slow water, where thin twine has more drag, and the '
            'more the slower it is (Choo and Casarella 1971): so has the model, but for knots and '
            'ropes.'
        ),
    )
    drawing = Drawing('flume', 'Model over tank; open marks do not count.', _figure(every))
    sections = [Section('States', rows, tables=(_table(every),))]
    if doubts:
        sections.append(Section('Why: what is assumed', tables=tuple(doubts)))
    return write_page(folder, page, sections, [drawing])


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


def run_flume(
    states: Sequence[FlumeState], folder: Path, on_progress: OnProgress = ignore
) -> list[MeasuredValue]:
    """Solve all states and write the page.

    Parameters
    ----------
    states
        As measured.
    folder
        Takes ``flume.json``, ``.md``, ``.html`` and ``.png``.
    on_progress
        Called after each state.
    """
    gear = load_gear(GEAR)
    every = compared(gear, states, on_progress)
    doubts = doubted(gear, states, on_progress)
    tables = [doubts_table(doubts, states)] if doubts else []
    return write_flume(folder, every, rows_of(every), tables)
