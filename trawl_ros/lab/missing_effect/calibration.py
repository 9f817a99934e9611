# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration of stated probabilities: reliability, calibration error, and the certified cut.

A cut is a threshold on the probability: a method names a node or leaf that reaches it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

import numpy as np
from scipy.stats import binom, binomtest

from trawl_ros.diagnosis.library.table import hypothesis_table
from trawl_ros.lab.missing_effect.records import (
    NOTHING,
    SOMETHING_ELSE,
    AnswerRecord,
    TruthRecord,
)

Case = tuple[TruthRecord, AnswerRecord]
"""Truth of a trial, and the answer to it."""


@dataclass(frozen=True)
class CalibrationOptions:
    """Options of the calibration.

    Attributes
    ----------
    bins
        Edges of the bins of the reliability diagram, from 0 to 1.
    equal_bins
        Number of bins of the calibration error; all have the same number of trials.
    cuts
        Cuts to test, from the highest to the lowest.
    most_wrong, confidence
        Largest allowed share of trials with a wrong name, and confidence of the test.
    least_probability
        Lower limit of the probability in the log score, so that a single 0 does not decide it.
    """

    bins: tuple[float, ...] = (0.0, 0.5, 0.7, 0.85, 0.95, 0.99, 1.0)
    equal_bins: int = 5
    cuts: tuple[float, ...] = (0.995, 0.99, 0.98, 0.97, 0.96, 0.95, 0.93, 0.9, 0.85, 0.8)
    most_wrong: float = 0.03
    confidence: float = 0.95
    least_probability: float = 1e-6


@dataclass(frozen=True)
class Claim:
    """Claim of an answer: a node, nothing or something else, with its probability.

    Attributes
    ----------
    path
        Path of the node, or `NOTHING` or `SOMETHING_ELSE`.
    probability
        Stated probability.
    right
        True if the claim holds for the trial.
    """

    path: str
    probability: float
    right: bool


@dataclass(frozen=True)
class ReliabilityBin:
    """Bin of a reliability diagram.

    Attributes
    ----------
    low, high
        Edges of the bin.
    mean
        Mean stated probability of its claims.
    right, number
        Number of right claims, and of all claims.
    """

    low: float
    high: float
    mean: float
    right: int
    number: int

    @property
    def interval(self) -> tuple[float, float]:
        """Exact 95 % confidence interval (Clopper and Pearson) of the share of right claims."""
        ends = binomtest(self.right, self.number).proportion_ci(method='exact')
        return float(ends.low), float(ends.high)


@dataclass(frozen=True)
class Certificate:
    """Result of the test of a cut.

    Attributes
    ----------
    cut
        Cut, a probability.
    wrong, number
        Number of trials with a wrong name, and of all trials.
    bound
        Upper confidence bound of the share of trials with a wrong name.
    needed
        Smallest number of trials at which the cut is certified with as many wrong names.
    """

    cut: float
    wrong: int
    number: int
    bound: float
    needed: int

    @property
    def holds(self) -> bool:
        """True if the cut is certified."""
        return self.number >= self.needed

    def __str__(self) -> str:
        text = f'{self.cut:g}: {self.wrong} of {self.number} wrong, rate at most {self.bound:.2%}, '
        return text + (
            'certified'
            if self.holds
            else f'not certified; that takes {self.needed} trials with {self.wrong} wrong'
        )


def claims(truth: TruthRecord, answer: AnswerRecord) -> dict[str, Claim]:
    """Return the claims of an answer by path: each node, nothing and something else.

    A node is a group of causes that one check on deck finds.
    """
    found = {
        node.path: Claim(node.path, answer.of(node.path), truth.holds(node.path))
        for node in hypothesis_table().nodes
    }
    for path, series in ((NOTHING, 'clean'), (SOMETHING_ELSE, 'outside')):
        found[path] = Claim(path, answer.of(path), truth.series == series)
    return found


def likeliest(case: Case) -> Claim:
    """Return the claim with the highest probability."""
    return max(claims(*case).values(), key=lambda claim: claim.probability)


def with_probabilities(cases: Sequence[Case]) -> list[Case]:
    """Return the cases whose answers state probabilities; some methods only give a verdict."""
    return [case for case in cases if case[1].probabilities]


def reliability(found: Sequence[Claim], options: CalibrationOptions) -> Iterator[ReliabilityBin]:
    """Yield the bins of the reliability diagram that hold claims."""
    for low, high in zip(options.bins[:-1], options.bins[1:], strict=True):
        # Bins exclude their upper edge, except the last one.
        last = high == options.bins[-1]
        inside = [
            claim
            for claim in found
            if low <= claim.probability < high or (last and claim.probability == high)
        ]
        if inside:
            mean = float(np.mean([claim.probability for claim in inside]))
            right = sum(claim.right for claim in inside)
            yield ReliabilityBin(low, high, mean, right, len(inside))


def calibration_error(found: Sequence[Claim], options: CalibrationOptions) -> float:
    """Return the debiased root mean square calibration error.

    See Kumar, Liang and Ma (2019), Verified uncertainty calibration.
    """
    order = sorted(found, key=lambda claim: claim.probability)
    total = 0.0
    for places in np.array_split(np.arange(len(order)), options.equal_bins):
        # The variance of the share cannot be estimated from one claim.
        if len(places) < 2:
            continue
        mean = float(np.mean([order[place].probability for place in places]))
        share = float(np.mean([order[place].right for place in places]))
        # Squaring the difference adds the sampling variance of the share, s (1 - s) / (n - 1).
        bias = share * (1.0 - share) / (len(places) - 1)
        total += len(places) / len(order) * ((mean - share) ** 2 - bias)
    return float(np.sqrt(max(total, 0.0)))


def log_score(cases: Sequence[Case], options: CalibrationOptions) -> float:
    """Return the mean log probability (nats) of the truth.

    The probabilities of two hidden causes are multiplied, as if they were independent. The result
    is NaN without cases.
    """
    scores = []
    for truth, answer in cases:
        claim = {'clean': NOTHING, 'outside': SOMETHING_ELSE}.get(truth.series)
        nodes = [(claim,)] if claim else [cause.nodes for cause in truth.causes]
        shares = [min(1.0, sum(answer.of(path) for path in paths)) for paths in nodes]
        scores.append(np.log(max(float(np.prod(shares)), options.least_probability)))
    return float(np.mean(scores)) if scores else float('nan')


def is_wrong_at(case: Case, cut: float) -> bool:
    """Return True if an answer names a wrong leaf or node at a cut.

    Of the named paths only the lowest of each branch count. An answer that states more than 0.5
    for `SOMETHING_ELSE` names nothing.
    """
    truth, answer = case
    if answer.of(SOMETHING_ELSE) > 0.5:
        return False
    nodes = {node.path for node in hypothesis_table().nodes}
    leaves = {path for path in answer.probabilities if path.rpartition('/')[0] in nodes}
    named = [path for path in nodes | leaves if answer.of(path) >= cut]
    lowest = [path for path in named if not any(other.startswith(f'{path}/') for other in named)]
    return any(not truth.holds(path) for path in lowest)


def certificates(cases: Sequence[Case], options: CalibrationOptions) -> tuple[Certificate, ...]:
    """Test cuts from the highest to the lowest, until one is not certified (Learn then Test).

    A cut is certified if the exact upper confidence bound of the share of trials with a wrong name
    is at most ``most_wrong``. The order of the tests is fixed in advance, so no correction for
    multiple tests is needed (Angelopoulos et al. 2021, arXiv 2110.01052).
    """
    found: list[Certificate] = []
    for cut in options.cuts if cases else ():
        wrong = sum(is_wrong_at(case, cut) for case in cases)
        # The upper end of the two-sided interval at 2c - 1 is the one-sided bound at confidence c.
        ends = binomtest(wrong, len(cases)).proportion_ci(2.0 * options.confidence - 1.0, 'exact')
        # Smallest n at which so few wrong names are unlikely if the true share is ``most_wrong``.
        needed = next(
            number
            for number in count(wrong + 1)
            if binom.cdf(wrong, number, options.most_wrong) <= 1.0 - options.confidence
        )
        found.append(Certificate(cut, wrong, len(cases), float(ends.high), needed))
        if not found[-1].holds:
            break
    return tuple(found)


def certified_cut(cases: Sequence[Case], options: CalibrationOptions) -> float | None:
    """Return the lowest certified cut, or None without one."""
    certified = [test.cut for test in certificates(cases, options) if test.holds]
    return certified[-1] if certified else None


def confusion(cases: Sequence[Case], number: int = 10) -> list[tuple[str, str, float, int]]:
    """Return the most frequent confusions of a hidden cause with a wrong claim.

    Parameters
    ----------
    cases
        Truth and answer of each trial.
    number
        Largest number of confusions.

    Returns
    -------
    list of tuple
        Hidden cause, path of the wrong claim, mean probability of it over the trials with this
        cause, and number of these trials. The largest sum of probabilities comes first.
    """
    trials: dict[str, list[Case]] = {}
    for case in cases:
        trials.setdefault(case[0].words, []).append(case)
    pairs = []
    for words, with_cause in trials.items():
        wrong: dict[str, float] = {}
        for truth, answer in with_cause:
            for path, claim in claims(truth, answer).items():
                if not claim.right and claim.probability:
                    wrong[path] = wrong.get(path, 0.0) + claim.probability
        pairs += [
            (words, path, total / len(with_cause), len(with_cause)) for path, total in wrong.items()
        ]
    return sorted(pairs, key=lambda pair: -pair[2] * pair[3])[:number]
