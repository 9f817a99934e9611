# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Calibration of stated probabilities: reliability, calibration error, and the certified cut."""

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
        Ends of the bins of the reliability diagram.
    equal_bins
        Number of bins, with equal numbers of trials, of the calibration error.
    cuts
        Cuts that are tested, the highest first.
    most_wrong, confidence
        Share of trials with a wrong name that a cut certifies, and its confidence.
    least_probability
        Smallest probability of the truth that the log score counts.
    """

    bins: tuple[float, ...] = (0.0, 0.5, 0.7, 0.85, 0.95, 0.99, 1.0)
    equal_bins: int = 5
    cuts: tuple[float, ...] = (0.995, 0.99, 0.98, 0.97, 0.96, 0.95, 0.93, 0.9, 0.85, 0.8)
    most_wrong: float = 0.03
    confidence: float = 0.95
    least_probability: float = 1e-6


@dataclass(frozen=True)
class Claim:
    """Likeliest claim of an answer: a node, nothing or something else, and if it is right."""

    path: str
    probability: float
    right: bool


@dataclass(frozen=True)
class ReliabilityBin:
    """Bin of a reliability diagram: mean probability, share that is right, and its interval."""

    low: float
    high: float
    mean: float
    right: int
    number: int

    @property
    def interval(self) -> tuple[float, float]:
        """Exact 95 % interval (Clopper and Pearson) of the share that is right."""
        ends = binomtest(self.right, self.number).proportion_ci(method='exact')
        return float(ends.low), float(ends.high)


@dataclass(frozen=True)
class Certificate:
    """Test of a cut.

    Attributes
    ----------
    cut
        The cut.
    wrong, number
        Number of trials with a wrong name, and of all trials.
    bound
        Upper bound of the rate of wrong names.
    needed
        Number of trials that certify the cut with as many wrong names.
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
    """Return the probability of each node with one check, of nothing and of something else."""
    found = {
        node.path: Claim(node.path, answer.of(node.path), truth.holds(node.path))
        for node in hypothesis_table().nodes
    }
    for path, series in ((NOTHING, 'clean'), (SOMETHING_ELSE, 'outside')):
        found[path] = Claim(path, answer.of(path), truth.series == series)
    return found


def likeliest(case: Case) -> Claim:
    """Return the likeliest claim of an answer."""
    return max(claims(*case).values(), key=lambda claim: claim.probability)


def with_probabilities(cases: Sequence[Case]) -> list[Case]:
    """Return the cases whose answers have probabilities."""
    return [case for case in cases if case[1].probabilities]


def reliability(found: Sequence[Claim], options: CalibrationOptions) -> Iterator[ReliabilityBin]:
    """Yield the bins of the reliability diagram that hold claims."""
    for low, high in zip(options.bins[:-1], options.bins[1:], strict=True):
        last = high == options.bins[-1]
        some = [
            own
            for own in found
            if low <= own.probability < high or (last and own.probability == high)
        ]
        if some:
            mean = float(np.mean([own.probability for own in some]))
            yield ReliabilityBin(low, high, mean, sum(own.right for own in some), len(some))


def calibration_error(found: Sequence[Claim], options: CalibrationOptions) -> float:
    """Return the debiased calibration error, root of the mean square.

    See Kumar, Liang and Ma (2019), Verified uncertainty calibration.
    """
    order = sorted(found, key=lambda own: own.probability)
    total = 0.0
    for places in np.array_split(np.arange(len(order)), options.equal_bins):
        if len(places) < 2:
            continue
        mean = float(np.mean([order[place].probability for place in places]))
        share = float(np.mean([order[place].right for place in places]))
        bias = share * (1.0 - share) / (len(places) - 1)
        total += len(places) / len(order) * ((mean - share) ** 2 - bias)
    return float(np.sqrt(max(total, 0.0)))


def log_score(cases: Sequence[Case], options: CalibrationOptions) -> float:
    """Return the mean log probability of what is hidden; causes of a pair count as independent."""
    scores = []
    for truth, answer in cases:
        own = {'clean': NOTHING, 'outside': SOMETHING_ELSE}.get(truth.series)
        nodes = [(own,)] if own else [cause.nodes for cause in truth.causes]
        shares = [min(1.0, sum(answer.of(path) for path in paths)) for paths in nodes]
        scores.append(np.log(max(float(np.prod(shares)), options.least_probability)))
    return float(np.mean(scores)) if scores else float('nan')


def is_wrong_at(case: Case, cut: float) -> bool:
    """Return True if a leaf or node that does not hold what is hidden reaches a cut."""
    truth, answer = case
    if answer.of(SOMETHING_ELSE) > 0.5:
        return False
    places = {node.path for node in hypothesis_table().nodes}
    leaves = {path for path in answer.probabilities if path.rpartition('/')[0] in places}
    named = [path for path in places | leaves if answer.of(path) >= cut]
    lowest = [path for path in named if not any(own.startswith(f'{path}/') for own in named)]
    return any(not truth.holds(path) for path in lowest)


def certificates(cases: Sequence[Case], options: CalibrationOptions) -> tuple[Certificate, ...]:
    """Test cuts by Learn then Test, from the highest on, until one is not certified.

    A cut is certified if the exact binomial bound of the rate of wrong names, at the confidence,
    is at most the largest allowed rate. The sequence is fixed before, so no correction is needed
    (Angelopoulos et al. 2021, arXiv 2110.01052).
    """
    found: list[Certificate] = []
    for cut in options.cuts if cases else ():
        wrong = sum(is_wrong_at(case, cut) for case in cases)
        ends = binomtest(wrong, len(cases)).proportion_ci(2.0 * options.confidence - 1.0, 'exact')
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
    held = [own.cut for own in certificates(cases, options) if own.holds]
    return held[-1] if held else None


def confusion(cases: Sequence[Case], number: int = 10) -> list[tuple[str, str, float, int]]:
    """Return the likeliest pairs of what is hidden and what else is claimed.

    Returns
    -------
    list of tuple
        Hidden cause, claimed node, mean probability of it over the trials with this cause, and the
        number of these trials.
    """
    trials: dict[str, list[Case]] = {}
    for case in cases:
        trials.setdefault(case[0].words, []).append(case)
    pairs = []
    for words, own in trials.items():
        wrong: dict[str, float] = {}
        for truth, answer in own:
            for path, claim in claims(truth, answer).items():
                if not claim.right and claim.probability:
                    wrong[path] = wrong.get(path, 0.0) + claim.probability
        pairs += [(words, path, total / len(own), len(own)) for path, total in wrong.items()]
    return sorted(pairs, key=lambda pair: -pair[2] * pair[3])[:number]
