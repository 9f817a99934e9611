# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Learning from a tow as a chain of parts as well as its steady windows; failures are reported."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from trawl_ros.core.errors import TrawlError, sentence_of
from trawl_ros.core.progress import WorkProgress
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.samples import Sample

if TYPE_CHECKING:
    from trawl_ros.estimation.live_motion import LiveMotion
    from trawl_ros.estimation.motion.outcome import MotionOutcome

ENDED = 'the node ended before the whole tow was fitted'
AT_END = 'the steady parts are fitted at the end of the tow'
BEFORE = 'the tow before the restart of the node is known by its steady windows alone'


@dataclass(frozen=True)
class MotionKnowledge:
    """Knowledge from the whole tow so far.

    Attributes
    ----------
    stamp
        End (ns) of the newest stretch; 0 before any.
    outcome
        Newest outcome, None before any.
    estimate
        Estimate that may be used, None where there is none.
    moved
        Distance of a coefficient from where the model was towed, in std.
    towings
        Times that the model was towed along all of it.
    whole
        True where all of it was fitted from beginning to end, as from a bag.
    why_not
        Reason for which nothing is learned at present; '' where it is.
    failed
        True where that is an error.
    lost
        Sentence on what of the tow it does not know; '' where that is nothing.
    """

    stamp: int = 0
    outcome: 'MotionOutcome | None' = None
    estimate: Estimate | None = None
    moved: float = 0.0
    towings: int = 0
    whole: bool = False
    why_not: str = 'the tow has just begun'
    failed: bool = False
    lost: str = ''

    @property
    def minutes(self) -> float:
        """Minutes of tow that it has learned from."""
        return 0.0 if self.outcome is None else self.outcome.duration_s / 60.0


class MotionLearner:
    """Learning from the whole tow, or at its end from its steady parts, by one thread.

    Parameters
    ----------
    gear
        The gear as the model has it.
    prior, net
        True if the prior takes part; if drag and weight of the net are estimated along.
    resumed
        True where the windows are those of a saved state.
    steady
        True if the steady parts alone are fitted, at the end.

    Attributes
    ----------
    knowledge
        Newest, as a record that other threads may read.
    at_end
        True if the whole tow is fitted where an identification is finished.
    """

    def __init__(
        self,
        gear: GearRecord,
        *,
        prior: bool = True,
        net: bool = False,
        resumed: bool = False,
        steady: bool = False,
    ) -> None:
        self._gear, self._prior, self._net, self._steady = gear, prior, net, steady
        self._live: LiveMotion | None = None
        self._begun = False
        self._revision = 0
        self.at_end = True
        self.knowledge = MotionKnowledge(lost=BEFORE if resumed else '')

    def reset(self) -> None:
        """Begin again with no tow."""
        if self._live is not None:
            self._live.reset()
        self.knowledge = MotionKnowledge()

    def feed(self, sample: Sample, windows: Estimate | None) -> bool:
        """Take a sample; tell whether more is known by it."""
        if not self._begun:
            self._begin()
        if self._live is None:
            return False
        if self.knowledge.failed or self._steady:
            self._live.record(sample)
            return False
        try:
            update = self._live.feed(sample, windows)
        except Exception as reason:
            # The windows go on, and the end of the tow is another attempt.
            self._know(why_not=sentence_of(reason), failed=True)
            return True
        if update is None:
            if self.knowledge.why_not != self._live.why_not:
                self._know(why_not=self._live.why_not)
            return False
        self._take(
            update.outcome, windows, update.stamp, usable=update.holds,
            moved=update.moved, towings=update.towings, why_not=self._live.why_not,
        )  # fmt: skip
        return True

    def refusal(self) -> str:
        """Reason for which `finish` would refuse at once; '' where it would not."""
        if self._live is None:
            return self.knowledge.why_not
        return self._live.refusal() if self.at_end else ENDED

    def finish(self, identification: Identification | None) -> 'MotionOutcome':
        """Fit the whole tow from beginning to end, as from a bag.

        Parameters
        ----------
        identification
            At rest; None where it has no steady window.

        Raises
        ------
        TrawlError
            If it cannot be learned from.
        """
        live, before = self._live, self.knowledge
        refused = self.refusal()
        if live is None or refused:
            raise TrawlError(refused)
        try:
            outcome = live.finish(identification, self._show, steady=self._steady)
        except Exception as reason:
            failed = not isinstance(reason, TrawlError)
            sentence = sentence_of(reason)
            # An estimate that has not converged at the end is not reliable.
            self.knowledge = replace(before, estimate=None, why_not=sentence, failed=failed)
            raise TrawlError(sentence) from reason
        windows = None if identification is None else identification.estimate
        last = max(
            tow.start_ns + round(len(tow) * tow.stretch_s * SECOND)
            for tow in (linear.tow for linear in outcome.fit.linear)
        )
        self._take(
            outcome, windows, last, usable=True,
            moved=0.0, towings=before.towings, why_not='', whole=True,
        )  # fmt: skip
        return outcome

    def _begin(self) -> None:
        self._begun = True
        # Its libraries are loaded where they are used: they would take a node's start long.
        from trawl_ros.estimation.bag_motion import why_windows_alone
        from trawl_ros.estimation.live_motion import LiveMotion

        if reason := why_windows_alone(self._gear, prior=self._prior):
            self._know(why_not=reason)
        else:
            self._live = LiveMotion(self._gear, net=self._net)
            if self._steady:
                self._know(why_not=AT_END)

    def _show(self, progress: WorkProgress) -> None:
        self._know(why_not=f'{progress.stage}: {progress.detail}')

    def _know(self, *, why_not: str, failed: bool = False) -> None:
        self.knowledge = replace(self.knowledge, why_not=why_not, failed=failed)

    def _take(
        self,
        outcome: 'MotionOutcome',
        windows: Estimate | None,
        stamp: int,
        *,
        usable: bool,
        moved: float,
        towings: int,
        why_not: str,
        whole: bool = False,
    ) -> None:
        estimate = None
        if usable:
            self._revision += 1
            estimate = replace(
                outcome.estimate,
                revision=self._revision + (windows.revision if windows else 0),
                stamp=stamp,
                windows=windows.windows if windows else 0,
            )
        self.knowledge = MotionKnowledge(
            stamp, outcome, estimate, moved, towings, whole, why_not, lost=self.knowledge.lost
        )
