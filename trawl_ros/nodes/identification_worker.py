"""The estimator in a thread of its own, so that solving a window blocks no callback.

Only this thread ever touches the `Identification`. Work comes in through one queue, in order;
what others may know of it goes out as immutable records.
"""

from collections.abc import Callable, Generator
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event, Thread

import numpy as np

from trawl_ros.errors import TrawlError
from trawl_ros.identification.estimate import Estimate
from trawl_ros.identification.pipeline import Identification, WindowUsed
from trawl_ros.identification.report import report
from trawl_ros.identification.writing import write_report
from trawl_ros.instruments.samples import Sample

QUIET_S = 0.5
"""A wish to finish is granted when no sample has come for this long."""

POLL_S = 0.005
"""How long an executor is held up when it asks whether a wish is granted."""


@dataclass(frozen=True)
class Outcome:
    """What a step of the estimator has led to.

    ``why_not`` says why there is no estimate yet; ``finished`` is the sentence with which a
    finished identification ends, None while it goes on.
    """

    estimate: Estimate | None = None
    rejected: tuple[tuple[str, int], ...] = ()
    why_not: str | None = None
    finished: str | None = None
    failed: bool = False


@dataclass(frozen=True)
class _Look:
    """A wish for a fresh `Outcome`."""


@dataclass(frozen=True)
class _Reset:
    """A wish to forget all."""


@dataclass(frozen=True)
class _Stop:
    """A wish to end the thread."""


class Finish:
    """A wish to finish; ``outcome`` is there once it is granted. Coroutines may await that."""

    def __init__(self) -> None:
        self._granted = Event()
        self.outcome = Outcome()

    def grant(self, outcome: Outcome) -> None:
        """Hand over the outcome."""
        self.outcome = outcome
        self._granted.set()

    def __await__(self) -> Generator[None, None, None]:
        # Some executors ask again at once, which would take the processor from the worker.
        while not self._granted.wait(POLL_S):
            yield


Work = Sample | Finish | _Look | _Reset | _Stop


class IdentificationWorker(Thread):
    """Feeds an identification.

    Parameters
    ----------
    identification
        Nobody else may use it from now on.
    output
        Folder for the report; None for none.
    truth
        True coefficients (12,) where known, for the report.
    estimated
        Called, in this thread, after each accepted window and at the end.
    dealt_with
        Called, in this thread, with the newest stamp (ns) so far after each sample was used. A
        sonar's reading is as old as its sweep is long, so stamps do not rise from one sample to
        the next.
    """

    def __init__(
        self,
        identification: Identification,
        output: Path | None,
        truth: np.ndarray | None,
        estimated: Callable[[Outcome], None],
        dealt_with: Callable[[int], None],
    ) -> None:
        super().__init__(name='identification', daemon=True)
        self._identification = identification
        self._output = output
        self._truth = truth
        self._estimated = estimated
        self._dealt_with = dealt_with
        self._queue: SimpleQueue[Work] = SimpleQueue()
        self._wishes: list[Finish] = []
        self._fed = 0
        self._newest = 0
        self._handed_over = 0
        self._dealt = 0
        self.outcome = self._outcome()

    @property
    def idle(self) -> bool:
        """Whether all samples that were handed over are dealt with."""
        return self._handed_over == self._dealt

    def feed(self, sample: Sample) -> None:
        """Hand over a sample."""
        self._handed_over += 1
        self._queue.put(sample)

    def reset(self) -> None:
        """Forget all that was handed over before."""
        self._queue.put(_Reset())

    def look(self) -> None:
        """Ask for `outcome` to be brought up to date."""
        self._queue.put(_Look())

    def finish(self) -> Finish:
        """Ask to bring the estimate to rest and to write the report, once it is quiet."""
        wish = Finish()
        self._queue.put(wish)
        return wish

    def stop(self) -> None:
        """End the thread after what it has to do, and wait for it."""
        self._queue.put(_Stop())
        self.join()

    def run(self) -> None:
        """Work until stopped."""
        while True:
            try:
                work = self._queue.get(timeout=QUIET_S if self._wishes else None)
            except Empty:
                self._grant()
                continue
            if isinstance(work, _Stop):
                if self._wishes:
                    self._grant()
                return
            self._do(work)

    def _do(self, work: Work) -> None:
        match work:
            case Finish():
                self._wishes.append(work)
            case _Reset():
                self._identification.reset()
                self._fed = 0
                self._newest = 0
                self.outcome = self._outcome()
            case _Look():
                if self.outcome.finished is None:
                    self.outcome = self._outcome()
            case _Stop():
                pass
            case _:
                self._fed += 1
                for event in self._identification.feed(work):
                    if isinstance(event, WindowUsed):
                        self.outcome = self._outcome()
                        self._estimated(self.outcome)
                self._newest = max(work.stamp, self._newest)
                self._dealt += 1
                self._dealt_with(self._newest)

    def _grant(self) -> None:
        wishes, self._wishes = self._wishes, []
        failed = False
        if self._fed:
            self._identification.finish()
            self._fed = 0
            try:
                sentence = self._report()
            except TrawlError as reason:
                sentence, failed = str(reason), True
            self.outcome = self._outcome(sentence, failed)
            if self.outcome.estimate is not None:
                self._estimated(self.outcome)
        elif self.outcome.finished is None:
            why_not = self._identification.why_not() or 'no samples were there to finish with'
            self.outcome = self._outcome(why_not, True)
        for wish in wishes:
            wish.grant(self.outcome)

    def _report(self) -> str:
        estimate = self._identification.estimate
        if estimate is None:
            raise TrawlError(self._identification.why_not() or 'nothing is estimated')
        if self._output is None:
            return f'{estimate.windows} windows used; {estimate.reason}'
        write_report(report(self._identification, self._truth), self._output)
        return f'{self._output}: identification.json of {estimate.windows} windows'

    def _outcome(self, finished: str | None = None, failed: bool = False) -> Outcome:
        identification = self._identification
        return Outcome(
            estimate=identification.estimate,
            rejected=tuple(identification.rejected.items()),
            why_not=identification.why_not(),
            finished=finished,
            failed=failed,
        )
