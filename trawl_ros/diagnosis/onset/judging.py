# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Finding that the evidence after a stretch supports: its onset, values and names."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import CandidateTable
from trawl_ros.diagnosis.onset.findings import Finding, OnsetValue
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence

SIMILAR_EVIDENCE = 6.0
"""Difference in twice the log evidence from the best candidate within which others are listed."""

NORMAL_QUANTILE_95 = 1.96
"""Half-width of a 95 % interval, in std."""


def finding(
    table: CandidateTable,
    number: int,
    end_ns: int,
    evidence: Sequence[OnsetEvidence],
    raised_ns: int,
    limit: float,
) -> Finding:
    """Return the finding that the evidence supports.

    Parameters
    ----------
    table
        The candidates.
    number
        Number of the finding.
    end_ns
        End (ns) of the newest stretch.
    evidence
        Evidence for all candidates, the rarest first.
    raised_ns
        Time (ns) at which the finding was raised.
    limit
        Rarity beyond which it is raised.
    """
    told = sorted(((weight(table, one), one) for one in evidence), key=lambda pair: -pair[0])
    (most, best), *others = told
    candidate = table.candidates[best.candidate]
    length = round(LIVE.stretch_s * SECOND)
    return Finding(
        number=number,
        state='raised',
        raised_ns=raised_ns,
        updated_ns=end_ns,
        onset_ns=end_ns - (best.age + 1) * length,
        # An onset late in a stretch looks like one at the beginning of the next.
        onset_low_ns=end_ns - (int(best.ages.max()) + 1) * length - length // 2,
        onset_high_ns=end_ns - int(best.ages.min()) * length,
        name=candidate.name,
        words=candidate.words,
        values=_values(table, best),
        alike=tuple(
            table.candidates[one.candidate].name
            for weighed, one in others
            # A candidate that fits as well is listed too, however many values it has.
            if weighed > most - SIMILAR_EVIDENCE or one.ratio >= best.ratio
        ),
        rarity=evidence[0].rarity,
        limit=limit,
    )


def _values(table: CandidateTable, best: OnsetEvidence) -> dict[str, OnsetValue]:
    """Return a candidate's values with their 95 % intervals, within the bounds."""
    own = [table.parameters[column] for column in table.candidates[best.candidate].columns]
    std = np.sqrt(np.diag(best.covariance))
    values = {}
    for parameter, departure, one in zip(own, best.values, std, strict=True):
        value = parameter.neutral + departure
        ends = np.array([value - NORMAL_QUANTILE_95 * one, value + NORMAL_QUANTILE_95 * one])
        low, high = np.clip(ends, parameter.low, parameter.high)
        values[parameter.name] = OnsetValue(float(value), float(low), float(high), parameter.unit)
    return values


def weight(table: CandidateTable, one: OnsetEvidence) -> float:
    """Return twice the log evidence: the likelihood ratio less the Occam factor."""
    own = list(table.candidates[one.candidate].columns)
    # The Occam factor is the determinant of the prior covariance over the posterior's.
    known = np.linalg.slogdet(one.covariance)[1]
    free = 2.0 * float(np.sum(np.log(table.scale[own])))
    return one.ratio - (free - float(known))
