# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Outcome of an identification in a thread of its own, as immutable records."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.whiteness import Whiteness
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.report.residuals import innovations
from trawl_ros.nodes.workers.motion_learner import MotionKnowledge
from trawl_ros.records.channels import CHANNELS


@dataclass(frozen=True)
class Readings:
    """Counts of a channel's readings that ``arrived``, and of those ``accepted``."""

    arrived: int
    accepted: int


@dataclass(frozen=True)
class EstimatorOutcome:
    """Outcome of a step of the estimator.

    Attributes
    ----------
    stamp
        Newest stamp (ns) of what was dealt with.
    estimate
        The newest one of the steady windows, None before the first.
    rejected
        Reason → count.
    found
        Reason → what was found last, in one sentence.
    readings
        Channel → counts.
    whiteness
        Channel → the test of its innovations; None with too few.
    fit
        Fit of the estimate.
    motion
        Knowledge from the whole tow; None where that is not wanted.
    why_not
        Reason for the lack of an estimate; None with one.
    troubles
        Errors by the work in which they came.
    finished, failed
        The sentence with which a finished identification ends, None while it goes on; and
        whether it is one on why there is no result.
    """

    stamp: int = 0
    estimate: Estimate | None = None
    rejected: Mapping[str, int] = field(default_factory=dict)
    found: Mapping[str, str] = field(default_factory=dict)
    readings: Mapping[str, Readings] = field(default_factory=dict)
    whiteness: Mapping[str, Whiteness | None] = field(default_factory=dict)
    fit: Fit | None = None
    motion: MotionKnowledge | None = None
    why_not: str | None = None
    troubles: Mapping[str, str] = field(default_factory=dict)
    finished: str | None = None
    failed: bool = False

    @property
    def told(self) -> Estimate | None:
        """Estimate to use: by the whole tow where it may be, else by its steady windows."""
        by_motion = None if self.motion is None else self.motion.estimate
        return self.estimate if by_motion is None else by_motion


def readings_of(identification: Identification) -> dict[str, Readings]:
    """Count the readings of each channel."""
    finder = identification.finder
    return {name: Readings(finder.arrived[name], finder.readings[name]) for name in CHANNELS}


def whiteness_of(identification: Identification) -> dict[str, Whiteness | None]:
    """Test the innovations of each channel."""
    return {
        innovation.channel: innovation.whiteness
        for innovation in innovations(identification.course)
    }
