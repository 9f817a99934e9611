# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Progress of a command, on a terminal and in a log."""

import time

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from trawl_ros.core.progress import WorkProgress

LINE_EVERY_S = 10.0
"""Interval of progress lines without a terminal, s."""

FIRST_RATE_S = 1.0
"""Elapsed time from which a rate is meaningful, s."""


def error_console() -> Console:
    """Return the console for progress and warnings, on stderr: stdout holds only results."""
    return Console(stderr=True, soft_wrap=True, highlight=False)


class ProgressDisplay:
    """Display of the progress of a library call: bars on a terminal, lines elsewhere.

    Parameters
    ----------
    console
        Console to write to.
    """

    def __init__(self, console: Console) -> None:
        self._console = console
        self._said = time.monotonic()
        self._began: dict[str, float] = {}
        self._tasks: dict[str, TaskID] = {}
        self._bars: Progress | None = None
        if console.is_terminal:
            self._bars = Progress(
                TextColumn('{task.description}'),
                BarColumn(),
                TextColumn('{task.fields[words]}'),
                TimeRemainingColumn(),
                console=console,
                transient=True,
            )

    def __call__(self, progress: WorkProgress) -> None:
        """Show the progress."""
        stage = progress.stage
        began = self._began.setdefault(stage, time.monotonic())
        words = _words(progress, time.monotonic() - began)
        if self._bars is not None:
            if stage not in self._tasks:
                self._tasks[stage] = self._bars.add_task(stage, total=progress.total, words='')
            self._bars.update(
                self._tasks[stage], completed=progress.done, total=progress.total, words=words
            )
        elif time.monotonic() - self._said >= LINE_EVERY_S:
            self._said = time.monotonic()
            self._console.print(f'{stage}: {words}' if words else stage, markup=False)

    def __enter__(self) -> 'ProgressDisplay':
        if self._bars is not None:
            self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars is not None:
            self._bars.stop()


def _words(progress: WorkProgress, elapsed_s: float) -> str:
    """Describe the progress of a stage; simulated time in minutes and relative to real time."""
    done, total, unit = progress.done, progress.total, progress.unit
    if unit == 's':
        of = '' if total is None else f' of {total / 60:.1f}'
        amount = f'{done / 60:.1f}{of} min'
        if elapsed_s >= FIRST_RATE_S:
            amount += f', {done / elapsed_s:.1f} × real time'
    elif total is not None:
        amount = f'{done:g} of {total:g} {unit}'.rstrip()
    else:
        amount = ''
    return ', '.join(part for part in (amount, progress.detail) if part)
