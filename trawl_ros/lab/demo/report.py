"""Terminal output of ``identification.json``, and of what all of the tow tells."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.report.motion import motion_lines, motion_table
from trawl_ros.estimation.report.report import Report


def load_result(folder: Path) -> dict[str, Any]:
    """Read ``identification.json``.

    Raises
    ------
    TrawlError
        If it is not there.
    """
    path = folder / 'identification.json'
    try:
        return dict(json.loads(path.read_text(encoding='utf-8')))
    except (OSError, ValueError) as reason:
        raise TrawlError(f'{path}: cannot be read; expected the result of the replay') from reason


def print_result(result: Mapping[str, Any], truth: Mapping[str, float]) -> None:
    """Print coefficients beside the true ones, and the errors per channel."""
    console = Console(highlight=False, soft_wrap=True)
    table = Table(title=f'Board coefficients from {result["windows"]} steady windows')
    table.add_column('', style='bold')
    for heading in ('start', 'value', 'low', 'high', 'true', 'in interval', 'determined'):
        table.add_column(heading, justify='right')
    for name, entry in result['coefficients'].items():
        numbers = [entry[key] for key in ('start', 'value', 'low', 'high')]
        inside = entry['low'] <= truth[name] <= entry['high']
        table.add_row(
            name,
            *(f'{number:.3f}' for number in (*numbers, truth[name])),
            'yes' if inside else 'no',
            'yes' if entry['determined'] else 'no',
        )
    console.print(table)
    table = Table(title='Mean error over mean measured value')
    table.add_column('', style='bold')
    for heading in ('before', 'after', 'held out'):
        table.add_column(heading, justify='right')
    for name, entry in result['channels'].items():
        errors = (entry[f'mnae_{key}'] for key in ('start', 'end', 'held_out'))
        table.add_row(name.replace('_', ' '), *map(_percent, errors))
    console.print(table)
    objective = ', '.join(f'{value:.4f} at the {key}' for key, value in result['objective'].items())
    console.print(f'Objective of eq. 35: {objective}.')


def print_motion(report: Report, duration_s: float) -> None:
    """Print what all of a tow of a duration (s) tells beside its windows, or why it does not."""
    console = Console(highlight=False, soft_wrap=True)
    if report.motion is not None:
        counted = f'{report.motion.duration_s / 60:.0f} of {duration_s / 60:.0f} min'
        console.print(
            f'All of the tow was learned from, hauling included: {counted}.', style='bold'
        )
        console.print(motion_table(report))
    for line in motion_lines(report):
        console.print(line, markup=False)


def _percent(value: float | None) -> str:
    return '–' if value is None else f'{100.0 * value:.1f} %'
