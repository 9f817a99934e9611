"""Progress along simulated or recorded time, on a terminal and in a log."""

import time
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

LINE_EVERY_S = 10.0
"""Without a terminal a line this often (s) says how far things are."""


def error_console() -> Console:
    """Console of progress and warnings, on stderr: stdout has results alone."""
    return Console(stderr=True, soft_wrap=True, highlight=False)


class TimeProgress:
    """Progress display: share of a stretch of time, and its speed over real time.

    Parameters
    ----------
    title
        What is going on, e.g. ``'towing'``.
    total_s
        The stretch, s; None when it is not known before.
    console
        Where to show it.
    """

    def __init__(self, title: str, total_s: float | None, console: Console) -> None:
        self._title = title
        self._total_s = total_s
        self._console = console
        self._began = time.monotonic()
        self._said = self._began
        self._done_s = 0.0
        self._bar: Progress | None = None
        if console.is_terminal:
            self._bar = Progress(
                TextColumn('{task.description}'),
                BarColumn(),
                TextColumn('{task.fields[words]}'),
                TimeRemainingColumn(),
                console=console,
            )
            self._task = self._bar.add_task(title, total=total_s, words='')

    @property
    def elapsed_s(self) -> float:
        """Wall-clock time since the beginning, s."""
        return time.monotonic() - self._began

    @property
    def speed_factor(self) -> float:
        """Speed over real time."""
        return self._done_s / max(self.elapsed_s, 1e-9)

    def update(self, done_s: float, words: str = '') -> None:
        """Update the progress (s), with a few words more."""
        self._done_s = done_s
        if self._bar is not None:
            self._bar.update(self._task, completed=self._done_s, words=self._words(words))
        elif time.monotonic() - self._said >= LINE_EVERY_S:
            self._said = time.monotonic()
            self._console.print(f'{self._title}: {self._words(words)}')

    def _words(self, more: str) -> str:
        of = '' if self._total_s is None else f' of {self._total_s / 60:.1f}'
        done = f'{self._done_s / 60:.1f}{of} min, {self.speed_factor:.1f} × real time'
        return f'{done}, {more}' if more else done

    def __enter__(self) -> 'TimeProgress':
        self._began = self._said = time.monotonic()
        if self._bar is not None:
            self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
