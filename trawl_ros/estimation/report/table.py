# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tables of the report for the terminal."""

from collections.abc import Sequence

from rich.table import Table

from trawl_ros.core.display_units import METRIC, DisplayUnits, quantity_of
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.chain import chain_lines
from trawl_ros.estimation.report.page import objective_line, percent
from trawl_ros.estimation.report.report import Report, coefficient_rows
from trawl_ros.estimation.report.sensors import SensorComparison, sensor_cells, sensor_headings
from trawl_ros.estimation.report.verdict import verdict


def coefficient_table(report: Report) -> Table:
    """Start, value, 95 % interval, truth where known, and whether the data determine it."""
    tows = len(set(report.tow_of.tolist()))
    of = f', {tows} tows' if tows > 1 else ''
    table = Table(title=f'Board coefficients from {report.source}{of}')
    table.add_column('', style='bold')
    headings = ['start', 'value', 'low', 'high']
    if report.truth is not None:
        headings += ['truth', 'in interval']
    for heading in (*headings, 'determined'):
        table.add_column(heading, justify='right')
    for row in coefficient_rows(report):
        cells = [f'{row[key]:.3f}' for key in ('start', 'value', 'low', 'high')]
        if report.truth is not None:
            cells += [f'{row["truth"]:.3f}', 'yes' if row['inside'] else '[red]no[/red]']
        table.add_row(str(row['name']), *cells, 'yes' if row['determined'] else 'no')
    return table


def channel_table(report: Report, units: DisplayUnits = METRIC) -> Table:
    """Mean absolute error over mean measured value per channel: before, after, left out."""
    table = Table(title='Error per channel: at rest in the windows before and after, and left out')
    table.add_column('', style='bold')
    left_out = 'tows held out' if report.held_out.by == 'tow' else 'states held out'
    for heading in ('mean measured', 'before', 'after', left_out):
        table.add_column(heading, justify='right')
    errors = report.errors
    for i, channel in enumerate(PAPER_CHANNELS):
        quantity = quantity_of(channel.name, channel.unit)
        table.add_row(
            channel.words,
            units.shown(float(report.measured[:, i].mean()), quantity),
            *(percent(errors[key][i]) for key in ('start', 'end', 'held_out')),
        )
    return table


def opening_line(report: Report) -> str:
    """Verdict in one sentence."""
    return verdict(report).fit


def closing_lines(report: Report) -> list[str]:
    """Closing remarks, one sentence per line."""
    estimate = report.estimate
    judged = verdict(report)
    lines = [*judged.knowledge, *judged.concerns, *chain_lines(report)]
    if report.windows:
        lines.insert(0, objective_line(report))
    if estimate.converged:
        lines.append(f'Converged: {estimate.reason}.')
    if report.rejected:
        counts = ', '.join(f'{reason} {count}' for reason, count in report.rejected.items())
        lines.append(f'Rejected: {counts}.')
    return lines


def sensor_table(rows: Sequence[SensorComparison]) -> Table:
    """Table for the terminal."""
    table = Table(title='Measured and predicted: mean over the windows (mean absolute error)')
    table.add_column('', style='bold')
    for heading in ('measured', *sensor_headings(rows)):
        table.add_column(heading, justify='right')
    for row in rows:
        table.add_row(*sensor_cells(row))
    return table
