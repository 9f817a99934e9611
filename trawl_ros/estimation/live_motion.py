# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of a whole tow while it goes on; at its end as from a bag, by the same functions.

What is done depends on the stamps of the samples alone: an estimate is the same at any rate of a
replay.
"""

from dataclasses import dataclass

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.bag_motion import (
    STRETCHES,
    fit_tows,
    moving_parts,
    towed_gear,
)
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.holdout import HeldOut
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.motion.series import TowRecorder
from trawl_ros.estimation.motion.stretches import LONGEST_S
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.tracking import MotionTracker
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.water import build_water
from trawl_ros.records.samples import Sample, WinchSample

WAIT_S, BEHIND_S = 3.0, 1.0
"""Time behind the end of a stretch at which it is cut, and to which readings are used then: those
of all topics, whichever comes first, have arrived."""


DECIDED_S = 120.0
"""Time behind its end at which a window is decided, whichever topic comes first: an estimate from
windows is begun with no sooner."""


@dataclass(frozen=True)
class MotionUpdate:
    """Estimate from the whole tow so far.

    Attributes
    ----------
    stamp
        End (ns) of its newest stretch.
    outcome
        Of the fit, linearised where the model was towed last.
    moved
        Largest distance of a coefficient from there, in std.
    towings
        Number of times that the model was towed along the tow.
    """

    stamp: int
    outcome: MotionOutcome
    moved: float
    towings: int

    @property
    def holds(self) -> bool:
        """True if the estimate may be used."""
        return self.outcome.fit.converged


class LiveMotion:
    """Fit of a whole tow while it goes on.

    Parameters
    ----------
    gear
        The gear as the model has it.
    options
        Of the fit.
    net
        True if drag and weight of the net are estimated along.

    Attributes
    ----------
    why_not
        Reason for which nothing is learned at present; '' where it is.
    """

    def __init__(
        self, gear: GearRecord, options: MotionOptions | None = None, *, net: bool = False
    ) -> None:
        self._gear, self._prior, self._net = gear, board_prior(gear), net
        self._options = options or MotionOptions()
        self._towed = towed_gear(gear, net=net)
        self._depth = build_water(gear).depth
        self.reset()

    def reset(self) -> None:
        """Begin again with no tow."""
        self._recorder = TowRecorder(self._depth)
        self._tracker = MotionTracker(self._towed, self._prior, self._options)
        self._number = 0
        self._windows: list[Estimate] = []
        self._owed: tuple[bool, Estimate | None] = False, None
        self.why_not = 'the tow has just begun'

    def feed(self, sample: Sample, windows: Estimate | None = None) -> MotionUpdate | None:
        """Take a sample.

        Parameters
        ----------
        sample
            Of any instrument.
        windows
            Estimate of the steady windows so far.

        Returns
        -------
        MotionUpdate or None
            With the first winch reading behind each stretch, where there is an estimate.
        """
        # Told before the rest of the work is done: whoever asked has it meanwhile.
        owed, known = self._owed
        if owed:
            self._owed = False, None
            self._tracker.catch_up(known)
        self._note(windows)
        if not self.record(sample) or not isinstance(sample, WinchSample):
            return None
        start = self._recorder.start_ns
        if start is None:
            return None
        length = round(STRETCHES.stretch_s * SECOND)
        number = (self._recorder.newest_ns - round(WAIT_S * SECOND) - start) // length
        if number <= self._number:
            return None
        self._number = number
        return self._update(start + number * length)

    def record(self, sample: Sample) -> bool:
        """Take a sample without an estimate; tell whether it belongs to the time learned from."""
        start = self._recorder.start_ns
        longest = round((LONGEST_S - STRETCHES.stretch_s) * SECOND)
        if start is not None and self._recorder.newest_ns > start + longest:
            self.why_not = f'learned from the first {LONGEST_S / 3600:g} h, which is the most'
            return False
        self._recorder.feed(sample)
        return True

    def refusal(self) -> str:
        """Reason for which `finish` would refuse the tow at once; '' where it would not."""
        tows, refused = self._tows(None)
        return '' if tows else '; '.join(refused)

    def finish(
        self,
        identification: Identification | None,
        on_progress: OnProgress = ignore,
        *,
        steady: bool = False,
    ) -> MotionOutcome:
        """Fit the tow as if it were read from a bag.

        Parameters
        ----------
        identification
            At rest, of the same samples; None where there is no steady window.
        on_progress, steady
            As of `fit_tows`.

        Raises
        ------
        TrawlError
            If it cannot be learned from.
        """
        tows, refused = self._tows(None)
        if not tows:
            raise TrawlError('; '.join(refused))
        return fit_tows(
            self._gear, identification, tows, [0] * len(tows), refused, on_progress,
            net=self._net, steady=steady,
        )  # fmt: skip

    def _tows(self, until_ns: int | None) -> tuple[list[MovingTow], list[str]]:
        tows: list[MovingTow] = []
        refused: list[str] = []
        try:
            read = self._recorder.readings('the tow', until_ns)
            tows += moving_parts(read, 'the tow', statistics=until_ns is None)
        except TrawlError as reason:
            refused.append(str(reason))
        return tows, refused

    def _note(self, windows: Estimate | None) -> None:
        """Note a new estimate of the windows; without one they are withdrawn."""
        if windows is None:
            self._windows = []
        elif not self._windows or self._windows[-1] is not windows:
            self._windows.append(windows)

    def _decided(self, end_ns: int) -> Estimate | None:
        """Newest estimate from windows that were decided for sure, and forget those before."""
        latest = end_ns - round(DECIDED_S * SECOND)
        number = sum(estimate.stamp <= latest for estimate in self._windows)
        self._windows = self._windows[max(number - 1, 0) :]
        return self._windows[0] if number else None

    def _update(self, end_ns: int) -> MotionUpdate | None:
        tows, refused = self._tows(end_ns + round(BEHIND_S * SECOND))
        self.why_not = '; '.join(refused)
        if not tows:
            return None
        windows = self._decided(end_ns)
        found = self._tracker.update(tows)
        self._owed = True, windows
        if found is None:
            self.why_not = self.why_not or 'the model is towed along the tow so far'
            return None
        numbers = (0,) * len(tows)
        outcome = MotionOutcome(found.fit, self._prior, numbers, tuple(refused), HeldOut())
        stamp = max(tow.start_ns + round(len(tow) * tow.stretch_s * SECOND) for tow in tows)
        return MotionUpdate(stamp, outcome, found.moved, found.towings)
