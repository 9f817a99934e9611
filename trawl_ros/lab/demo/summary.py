# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What the demo prints of its results."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.report.motion import motion_lines, motion_table
from trawl_ros.estimation.report.report import Report
from trawl_ros.lab.demo.short_tows import Finding


def load_result(folder: Path) -> dict[str, Any]:
    """Read ``identification.json`` of a folder.

    Raises
    ------
    TrawlError
        If it is not there.
    """
    path = folder / 'identification.json'
    try:
        return dict(json.loads(path.read_text(encoding='utf-8')))
    except (OSError, ValueError) as reason:
        raise TrawlError(
            f'{path}: cannot be read; expected the report of the identification'
        ) from reason


def print_result(result: Mapping[str, Any], truth: Mapping[str, float]) -> None:
    """Print the coefficients next to the true ones, and the errors per channel."""
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
    """Print the estimate from the whole tow of a duration (s), or why there is none."""
    console = Console(highlight=False, soft_wrap=True)
    if report.motion is not None:
        counted = f'{report.motion.duration_s / 60:.0f} of {duration_s / 60:.0f} min'
        console.print(f'The whole tow was used, hauling included: {counted}.', style='bold')
        console.print(motion_table(report))
    for line in motion_lines(report):
        console.print(line, markup=False)


def _percent(value: float | None) -> str:
    return '–' if value is None else f'{100.0 * value:.1f} %'


def refitted_line(result: Mapping[str, Any], truth: Mapping[str, float]) -> str:
    """Return the errors of the model before and after the refit, from ``identification.json``.

    Parameters
    ----------
    result
        Content of the file.
    truth
        True coefficients by name.
    """
    errors = ', '.join(
        f'{100.0 * channel["mnae_start"]:.1f} to {100.0 * channel["mnae_end"]:.1f} % in '
        f'{name.replace("_", " ")}'
        for name, channel in result['channels'].items()
        if name != 'net_depth'
    )
    held = sum(
        own['low'] <= truth[name] <= own['high'] for name, own in result['coefficients'].items()
    )
    return (
        f'The boards were refitted from {result["windows"]} steady windows; the model errs less: '
        f'{errors}. {held} of {len(truth)} intervals hold the true coefficient.'
    )


def finding_lines(found: Finding) -> tuple[str, str, str]:
    """Return what the model missed, what was named, and what is left with the repaired gear."""
    (effect,) = found.numbers['effects']
    values = ', '.join(
        f'{name} {own["value"]:.3g} (95 %: {own["low"]:.3g} to {own["high"]:.3g}) '
        f'{own["unit"]}'.rstrip()
        for name, own in effect['parameters'].items()
    )
    made, smallest, times = found.sizes.values()
    return (
        f'In the short tows the model, boards refitted, misses by: {found.errors("before")}.',
        f'Named: {found.name}: {values}. It was made {made} m/s too much, {times:.1f} × '
        f'the {smallest:.3f} m/s that four of five such trials detect.',
        f'Repaired: with it in the gear file the errors are: {found.errors("after")}. '
        f'Instruments alone would give: {found.errors("expected")}.',
    )
