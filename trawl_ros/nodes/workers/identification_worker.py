# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Worker thread of the estimator, so that solving a window blocks no callback.

Only this thread ever touches the `Identification`. Work comes in through one queue, in order;
what others may know of it goes out as immutable records.
"""

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, replace
from threading import Event

from trawl_ros.estimation.fit.whiteness import Whiteness
from trawl_ros.estimation.pipeline import Identification, WindowUsed
from trawl_ros.nodes.runtime.reading import Reached
from trawl_ros.nodes.workers.motion_learner import MotionLearner
from trawl_ros.nodes.workers.outcome import EstimatorOutcome, readings_of, whiteness_of
from trawl_ros.nodes.workers.worker import POLL_S, Worker
from trawl_ros.records.samples import Sample

QUIET_S = 0.5
"""A wish to finish is granted when no sample has come for this long."""


@dataclass(frozen=True)
class _Look:
    """Request for a fresh `EstimatorOutcome`."""


@dataclass(frozen=True)
class _Reset:
    """Request to reset the identification."""


class Finish:
    """Request to finish; ``outcome`` is there once it is granted. Coroutines may await that.

    ``whole`` is true if the whole tow is fitted too, where it is learned from.
    """

    def __init__(self, *, whole: bool = True) -> None:
        self.whole = whole
        self._granted = Event()
        self.outcome = EstimatorOutcome()

    def grant(self, outcome: EstimatorOutcome) -> None:
        """Hand over the outcome."""
        self.outcome = outcome
        self._granted.set()

    def __await__(self) -> Generator[None, None, None]:
        # Some executors ask again at once, which would take the processor from the worker.
        while not self._granted.wait(POLL_S):
            yield


Work = Sample | Finish | _Look | _Reset


class IdentificationWorker(Worker[Work]):
    """Worker thread that feeds an identification.

    Parameters
    ----------
    identification
        Nobody else may use it from now on.
    on_outcome
        Called with what is new: after each window, used or not, at the end, and after `look`
        where counts have changed.
    dealt_with
        Called with the newest stamp (ns) so far after each sample was used. A sonar's reading is
        as old as its sweep is long, so stamps do not rise from one sample to the next.
    save
        Called after each window, and before the estimate is brought to rest, to save the state.
    report
        Called at the end to write the report; gives the sentence with which all ends.
    motion
        Learning from the whole tow, where that is wanted.

    All of these are called in this thread.
    """

    def __init__(
        self,
        identification: Identification,
        on_outcome: Callable[[EstimatorOutcome], None],
        dealt_with: Callable[[int], None],
        save: Callable[[Identification], None],
        report: Callable[[Identification], str],
        motion: MotionLearner | None = None,
    ) -> None:
        super().__init__('identification')
        self._identification = identification
        self._on_outcome = on_outcome
        self._dealt_with = dealt_with
        self._save = save
        self._report = report
        self._motion = motion
        self._wishes: list[Finish] = []
        self._fed = 0
        self._reached = Reached(
            max((event.window.end_ns for event in identification.course), default=0)
        )
        self._whiteness: Mapping[str, Whiteness | None] = whiteness_of(identification)
        self.outcome = self._outcome()

    def reset(self) -> None:
        """Discard all that was handed over before."""
        self.put(_Reset())

    def look(self) -> None:
        """Request an update of `outcome`."""
        self.put(_Look())

    def finish(self, *, whole: bool = True) -> Finish:
        """Request to converge the estimate and to write the report, once no sample waits.

        If ``whole``, the whole tow is fitted, which takes minutes for each hour of it.
        """
        wish = Finish(whole=whole)
        self.put(wish)
        return wish

    def patience_s(self) -> float | None:
        """Return the quiet time (s) after which a wish to finish is granted."""
        return QUIET_S if self._wishes else None

    def be_quiet(self) -> None:
        """Grant the wishes to finish."""
        self._grant()

    def run(self) -> None:
        """Work until stopped; wishes that are left are granted."""
        super().run()
        if self._wishes:
            self._grant()

    def do(self, work: Work) -> None:
        """Feed a sample, or follow a request."""
        match work:
            case Finish():
                self._wishes.append(work)
            case _Reset():
                self._identification.reset()
                if self._motion is not None:
                    self._motion.reset()
                self._fed, self._reached = 0, Reached()
                self._whiteness = {}
                self.troubles.clear()
                self._tell()
            case _Look():
                self._look()
            case _:
                self.attempt('estimating', lambda: self._use(work))
                self.attempt('reporting', lambda: self._dealt_with(self._reached.stamp))

    def _look(self) -> None:
        if self.outcome.finished is None:
            before, self.outcome = self.outcome, self._outcome()
            if self.outcome.rejected != before.rejected:
                self._on_outcome(self.outcome)

    def _use(self, sample: Sample) -> None:
        self._fed += 1
        events = self._identification.feed(sample)
        self._reached.take(sample.stamp)
        used = [event for event in events if isinstance(event, WindowUsed)]
        if events:
            self._whiteness = whiteness_of(self._identification)
        # One sample may decide several windows, and each brings an estimate.
        for event in used[:-1]:
            self._on_outcome(replace(self._outcome(), estimate=event.estimate))
        # After the windows, whose estimate it may begin with.
        estimate = self._identification.estimate
        learned = self._motion is not None and self._motion.feed(sample, estimate)
        if events or learned:
            self._tell()
        if used:
            self._keep()

    def _keep(self) -> None:
        self.troubles.pop('saving', None)
        self.attempt('saving', lambda: self._save(self._identification))

    def _tell(self, finished: str | None = None, failed: bool = False) -> None:
        self.outcome = self._outcome(finished, failed)
        self._on_outcome(self.outcome)

    def _grant(self) -> None:
        wishes, self._wishes = self._wishes, []
        if self._fed:
            # Saved before: brought to rest it would go on otherwise than without an interruption.
            self._keep()
            self._fed = 0
            if self._motion is not None:
                self._motion.at_end = any(wish.whole for wish in wishes)
            sentence, failed = self._end()
            self._tell(sentence, failed)
        elif self.outcome.finished is None:
            why_not = self._identification.why_not() or 'no samples were there to finish with'
            self.outcome = self._outcome(why_not, True)
        for wish in wishes:
            wish.grant(self.outcome)

    def _end(self) -> tuple[str, bool]:
        sentences: list[str] = []

        def end() -> None:
            self._identification.finish()
            self._whiteness = whiteness_of(self._identification)
            sentences.append(self._report(self._identification))

        self.troubles.pop('finishing', None)
        self.attempt('finishing', end)
        return (sentences[0], False) if sentences else (self.troubles.pop('finishing'), True)

    def _outcome(self, finished: str | None = None, failed: bool = False) -> EstimatorOutcome:
        identification = self._identification
        return EstimatorOutcome(
            stamp=self._reached.stamp,
            estimate=identification.estimate,
            rejected=identification.rejected,
            found=identification.found,
            readings=readings_of(identification),
            whiteness=self._whiteness,
            fit=identification.estimator.fit,
            motion=None if self._motion is None else self._motion.knowledge,
            why_not=identification.why_not(),
            troubles=dict(self.troubles),
            finished=finished,
            failed=failed,
        )
