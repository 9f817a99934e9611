# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Onsets in tows that are over: the monitor fed from recordings, as the node is from topics."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import Slice
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.onset.history import WatchedCourse
from trawl_ros.diagnosis.onset.knowledge import Knowledge
from trawl_ros.diagnosis.onset.monitor import OnsetMonitor
from trawl_ros.diagnosis.onset.watch import JUST_BEGUN, WatchedStretch
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.windows.noise_density import noise_densities
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.samples import Sample

LESS_KNOWN = 2.0
"""Factor on the std of an estimate that was made with what is looked for in its data."""


@dataclass(frozen=True)
class OnsetsInTow:
    """Onsets in a tow.

    Attributes
    ----------
    tow
        Its name.
    start_ns
        Stamp of its first sample.
    watched, unwatched
        Stretches of 30 s that were judged, and that could not be.
    why_not
        Reason why the last of these could not be.
    findings
        All that was not withdrawn.
    course
        Innovations and evidence over time.
    """

    tow: str
    start_ns: int
    watched: int
    unwatched: int
    why_not: str
    findings: tuple[Finding, ...]
    course: WatchedCourse

    def sentences(self) -> list[str]:
        """Sentence for each onset, or that there was none."""
        if not self.watched:
            return [f'{self.tow}: could not be watched for what begins in it ({self.why_not}).']
        if not self.findings:
            return [f'{self.tow}: nothing was found to begin in {self.watched / 2:.0f} minutes.']
        told = self.findings
        return [f'{self.tow}, minute {self.minute(one):.1f}: {one.sentence()}.' for one in told]

    def minute(self, found: Finding) -> float:
        """Minutes from the tow's first sample to an onset."""
        return (found.onset_ns - self.start_ns) / 60e9


def by_estimate(estimate: Estimate, board: Slice, windows: Sequence[SteadyWindow]) -> Knowledge:
    """Knowledge by the board's slice of an estimate from steady windows of the same tows."""
    covariance = LESS_KNOWN**2 * np.array(estimate.covariance)[board, board]
    return Knowledge(estimate.values[board], covariance, noise_densities(windows))


def onsets_in(
    gear: GearRecord, knowledge: Knowledge, tow: str, samples: Iterable[Sample]
) -> OnsetsInTow:
    """Watch a tow from its first sample to its last."""
    told: list[WatchedStretch] = []
    monitor = OnsetMonitor(gear, knowledge, on_stretch=told.append)
    start_ns = 0
    for sample in samples:
        start_ns = start_ns or sample.stamp
        monitor.feed(sample)
    why_not = next((one.why_not for one in reversed(told) if one.why_not), JUST_BEGUN)
    kept = (found for found in monitor.findings.values() if found.state != 'withdrawn')
    return OnsetsInTow(
        tow, start_ns, monitor.watched, monitor.unwatched, why_not, tuple(kept),
        WatchedCourse.of(told),
    )  # fmt: skip
