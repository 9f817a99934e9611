# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Finding that the evidence after a stretch supports: its onset, values and names."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.diagnosis.onset.candidates import CandidateTable
from trawl_ros.diagnosis.onset.findings import Finding, OnsetValue
from trawl_ros.diagnosis.onset.part import LENGTH_NS
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence

SIMILAR_EVIDENCE = 6.0
"""Difference in twice the log evidence from the best candidate within which others are listed."""

NORMAL_QUANTILE_95 = 1.96
"""Half-width of a 95 % interval, in std."""


def finding(
    table: CandidateTable, evidence: Sequence[OnsetEvidence], end_ns: int, limit: float
) -> Finding:
    """Return the finding that the evidence supports, as it is raised, without a number.

    Parameters
    ----------
    table
        The candidates.
    evidence
        Evidence for all candidates, the rarest first.
    end_ns
        End (ns) of the newest stretch.
    limit
        Rarity beyond which it is raised.
    """
    best, *others = sorted(evidence, key=lambda one: -weight(table, one))
    least = weight(table, best) - SIMILAR_EVIDENCE
    # A candidate that fits as well is listed too, however many values it has.
    similar = [one for one in others if weight(table, one) > least or one.ratio >= best.ratio]
    return Finding(
        number=0,
        state='raised',
        raised_ns=end_ns,
        updated_ns=end_ns,
        onset_ns=end_ns - (best.age + 1) * LENGTH_NS,
        # An onset late in a stretch looks like one at the beginning of the next.
        onset_low_ns=end_ns - (int(best.ages.max()) + 1) * LENGTH_NS - LENGTH_NS // 2,
        onset_high_ns=end_ns - int(best.ages.min()) * LENGTH_NS,
        name=best.candidate.name,
        words=best.candidate.words,
        values=_values(table, best),
        alike=tuple(one.candidate.name for one in similar),
        rarity=evidence[0].rarity,
        limit=limit,
    )


def _values(table: CandidateTable, best: OnsetEvidence) -> dict[str, OnsetValue]:
    """Return a candidate's values with their 95 % intervals, within the bounds."""
    half = NORMAL_QUANTILE_95 * np.sqrt(np.diag(best.covariance))
    values = {}
    for column, departure, wide in zip(best.candidate.columns, best.values, half, strict=True):
        own = table.parameters[column]
        value = own.neutral + float(departure)
        low, high = max(value - float(wide), own.low), min(value + float(wide), own.high)
        values[own.name] = OnsetValue(value, low, high, own.unit)
    return values


def weight(table: CandidateTable, one: OnsetEvidence) -> float:
    """Return twice the log evidence: the likelihood ratio less the Occam factor."""
    # The Occam factor is the determinant of the prior covariance over the posterior's.
    free = 2.0 * np.sum(np.log(table.scale[list(one.candidate.columns)]))
    return one.ratio - float(free - np.linalg.slogdet(one.covariance)[1])
