# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Progress and outcome of the lab's commands on the terminal."""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click
from rich.console import Console

from trawl_ros.cli.console.interruption import INTERRUPTED
from trawl_ros.cli.console.progress import ProgressDisplay, error_console
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import reached_in_words


@contextmanager
def stoppable(left: str = 'no report is written') -> Iterator[tuple[ProgressDisplay, Console]]:
    """Show progress; Ctrl-C ends the command and prints ``left``, what remains of its work."""
    console = error_console()
    try:
        with ProgressDisplay(console) as display:
            yield display, console
    except KeyboardInterrupt:
        console.print(f'stopped; {left}')
        raise SystemExit(INTERRUPTED) from None


def print_missed(rows: Iterable[MeasuredValue], console: Console) -> None:
    """Print the targets that are missed, with the reason."""
    for row in rows:
        if not row.ok:
            console.print(f'missed: {row.what}: {row.figure}. {row.note}'.rstrip(), markup=False)


def print_reached(rows: Sequence[MeasuredValue], report: Path) -> None:
    """Print how many targets are reached, and where the report is."""
    click.echo(f'{reached_in_words(rows)} {report}'.strip())
