# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Progress of long work, as records for a callback."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count


@dataclass(frozen=True)
class WorkProgress:
    """Progress of a long piece of work at one moment.

    Attributes
    ----------
    stage
        Stage of the work in a few words, such as ``'towing'``.
    done, total
        Amount of this stage that is done, and total amount; None if it is unknown.
    unit
        Unit of both: ``'s'`` for simulated or recorded time, or a noun such as ``'bags'``.
    detail
        Further words, such as the step of a scenario.

    Examples
    --------
    >>> import trawl_ros
    >>> stages = set()
    >>> bag = trawl_ros.tow('tow.yaml', 'watched', on_progress=lambda at: stages.add(at.stage))
    >>> sorted(stages)
    ['looking for the steady states', 'towing']
    """

    stage: str
    done: float = 0.0
    total: float | None = None
    unit: str = ''
    detail: str = ''


OnProgress = Callable[[WorkProgress], None]
"""Callback for progress. An exception that it raises stops the work like an interruption."""


def ignore(progress: WorkProgress) -> None:
    """Ignore the progress."""


def step_counter(stage: str, total: int, on_progress: OnProgress) -> Callable[[], None]:
    """Return a function that reports one more step of a stage; report zero steps first."""
    numbers = count()

    def step() -> None:
        on_progress(WorkProgress(stage, next(numbers), total))

    step()
    return step
