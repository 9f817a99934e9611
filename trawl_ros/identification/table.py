"""The report as tables for people."""

import math

from rich.table import Table

from trawl_ros.identification.objective import PAPER_CHANNELS
from trawl_ros.identification.report import Report
from trawl_ros.model.board import COEFFICIENTS


def coefficient_table(report: Report) -> Table:
    """Start, value, 95 % interval, truth where known, and whether the data determine it."""
    table = Table(title=f'Board coefficients from {report.estimate.windows} steady windows')
    table.add_column('', style='bold')
    headings = ['start', 'value', 'low', 'high']
    if report.truth is not None:
        headings += ['truth', 'in interval']
    for heading in (*headings, 'determined'):
        table.add_column(heading, justify='right')
    estimate = report.estimate
    for i, name in enumerate(COEFFICIENTS):
        numbers = [report.prior.start[i], estimate.values[i], estimate.low[i], estimate.high[i]]
        cells = [f'{number:.3f}' for number in numbers]
        if report.truth is not None:
            truth = report.truth[i]
            inside = estimate.low[i] <= truth <= estimate.high[i]
            cells += [f'{truth:.3f}', 'yes' if inside else '[red]no[/red]']
        cells.append('yes' if estimate.determined[i] else 'no')
        table.add_row(name, *cells)
    return table


def channel_table(report: Report) -> Table:
    """Mean absolute error over mean measured value per channel: before, after, held out."""
    table = Table(title='Error per channel')
    table.add_column('', style='bold')
    for heading in ('mean measured', 'before', 'after', 'held out'):
        table.add_column(heading, justify='right')
    errors = report.errors
    for i, channel in enumerate(PAPER_CHANNELS):
        mean, unit = report.measured[:, i].mean(), channel.unit
        if unit == 'N':
            mean, unit = mean / 1e3, 'kN'
        table.add_row(
            channel.name.replace('_', ' '),
            f'{mean:.1f} {unit}',
            *(_percent(errors[key][i]) for key in ('start', 'end', 'held_out')),
        )
    return table


def closing_lines(report: Report) -> list[str]:
    """What remains to be said, one sentence per line."""
    estimate, objectives = report.estimate, report.objectives
    truth = f', {objectives["truth"]:.4f} at the truth' if 'truth' in objectives else ''
    rest = 'converged' if estimate.converged else 'NOT converged'
    lines = [
        f'Objective of eq. 35: {objectives["start"]:.4f} at the start, '
        f'{objectives["end"]:.4f} at the end{truth}.',
        f'{rest.capitalize() if estimate.converged else rest}: {estimate.reason}.',
        f'Condition number {estimate.condition_number:.3g}; the stated '
        f'noise is taken {estimate.noise_scale:.2f} times, as residuals ask.',
    ]
    if estimate.undetermined:
        names = '; '.join(str(combination) for combination in estimate.undetermined)
        lines.append(f'The data do not determine {names}.')
    if estimate.active_bounds:
        lines.append(f'On a bound: {"; ".join(estimate.active_bounds)}.')
    if report.rejected:
        counts = ', '.join(f'{reason} {count}' for reason, count in report.rejected.items())
        lines.append(f'Rejected: {counts}.')
    return lines


def _percent(value: float) -> str:
    return f'{100.0 * value:.1f} %' if math.isfinite(value) else '–'
