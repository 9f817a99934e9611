"""Outcome of a report on the terminal: the targets that are missed, and how many are reached."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import click
from rich.console import Console

from trawl_ros.lab.report.measured import MeasuredValue


def print_missed(rows: Iterable[MeasuredValue], console: Console) -> None:
    """Print the targets that are missed, with the reason."""
    for row in rows:
        if not row.ok:
            console.print(f'missed: {row.what}: {row.figure}. {row.note}'.rstrip(), markup=False)


def print_reached(rows: Sequence[MeasuredValue], report: Path) -> None:
    """Print how many targets are reached, and where the report is."""
    asked = [row for row in rows if row.target is not None]
    click.echo(f'{sum(row.ok for row in asked)} of {len(asked)} targets are reached: {report}')
