# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Judging of the evidence after a stretch: the finding it makes, its onset, values and names."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.onset.candidates import CandidateTable
from trawl_ros.diagnosis.onset.findings import Finding, OnsetValue
from trawl_ros.diagnosis.onset.ratios import OnsetEvidence
from trawl_ros.diagnosis.onset.stretches import LIVE

ALIKE = 6.0
"""Candidates whose evidence comes within this of the best's are listed with it, as by the rules
for steady windows."""


def finding(
    table: CandidateTable,
    number: int,
    end_ns: int,
    evidence: Sequence[OnsetEvidence],
    raised_ns: int,
    limit: float,
) -> Finding:
    """Make the finding that evidence speaks for.

    Parameters
    ----------
    table
        The candidates.
    number
        Of the finding.
    end_ns
        End (ns) of the newest stretch.
    evidence
        Of all candidates, the rarest first.
    raised_ns
        Time (ns) at which it was raised.
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
        # An onset within a stretch may be taken for one with the next.
        onset_low_ns=end_ns - (int(best.ages.max()) + 1) * length - length // 2,
        onset_high_ns=end_ns - int(best.ages.min()) * length,
        name=candidate.name,
        words=candidate.words,
        values=_values(table, best),
        alike=tuple(
            table.candidates[one.candidate].name
            for weighed, one in others
            # A candidate that fits no worse is not told apart, however many values it takes.
            if weighed > most - ALIKE or one.ratio >= best.ratio
        ),
        rarity=evidence[0].rarity,
        limit=limit,
    )


def _values(table: CandidateTable, best: OnsetEvidence) -> dict[str, OnsetValue]:
    """Values of a candidate's parameters with their intervals of 95 %, within what is possible."""
    own = [table.parameters[column] for column in table.candidates[best.candidate].columns]
    std = np.sqrt(np.diag(best.covariance))
    values = {}
    for parameter, departure, one in zip(own, best.values, std, strict=True):
        value = parameter.neutral + departure
        ends = np.array([value - 1.96 * one, value + 1.96 * one])
        low, high = np.clip(ends, parameter.low, parameter.high)
        values[parameter.name] = OnsetValue(float(value), float(low), float(high), parameter.unit)
    return values


def weight(table: CandidateTable, one: OnsetEvidence) -> float:
    """Twice the logarithm of the evidence: the ratio, less what its values could have been."""
    own = list(table.candidates[one.candidate].columns)
    # The determinant of the prior's covariance over the posterior's.
    known = np.linalg.slogdet(one.covariance)[1]
    free = 2.0 * float(np.sum(np.log(table.scale[own])))
    return one.ratio - (free - float(known))
