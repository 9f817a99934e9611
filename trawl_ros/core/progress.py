"""Progress of long work, as records that a callback is given."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count


@dataclass(frozen=True)
class WorkProgress:
    """A moment of a long piece of work.

    Attributes
    ----------
    stage
        Of the work, in a word or two: ``'towing'``.
    done, total
        Amount of this stage that is done, and in all; None where that is not known.
    unit
        Of both: ``'s'`` for simulated or recorded time, or a noun such as ``'bags'``.
    detail
        A few words more, such as the step of a scenario.

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
"""A callback for progress. It may raise: the work then ends as if it were interrupted."""


def ignore(progress: WorkProgress) -> None:
    """Take no notice of progress."""


def step_counter(stage: str, total: int, on_progress: OnProgress) -> Callable[[], None]:
    """Make a function that reports one more step of a stage as done; report that none is yet."""
    numbers = count()

    def step() -> None:
        on_progress(WorkProgress(stage, next(numbers), total))

    step()
    return step
