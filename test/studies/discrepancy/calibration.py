"""Calibration of the posterior: temperature, reliability, and the certified cut."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp
from scipy.stats import binom

from studies.discrepancy.trial import BlindTrial
from trawl_ros.lab.trials.answers import holds, right_nodes

TEMPERATURES = (0.7, 0.85, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0)
CUTS = (0.995, 0.99, 0.98, 0.97, 0.96, 0.95, 0.93, 0.9, 0.85, 0.8)
MOST_WRONG, CONFIDENCE = 0.03, 0.95
"""Share of trials with a wrong name that the cut certifies, and its confidence."""


def tempered(trial: BlindTrial, temperature: float) -> np.ndarray:
    """Return the probabilities of the kept explanations at a temperature."""
    weights = np.array([odds + factor / temperature for *_, odds, factor in trial.explanations])
    shares: np.ndarray = np.exp(weights - logsumexp(weights))
    return shares


def of_truth(trial: BlindTrial, temperature: float) -> float:
    """Return the probability of what is hidden: its node, nothing, or something else."""
    shares = tempered(trial, temperature)
    held = 0.0
    for share, (names, nodes, unknown, _, _) in zip(shares, trial.explanations, strict=True):
        if trial.series == 'clean':
            held += share * (not names and not unknown)
        elif trial.series == 'outside':
            held += share * bool(unknown)
        else:
            held += share * all(set(right_nodes(cause)) & set(nodes) for cause in trial.effects)
    return float(held)


def log_score(trials: Sequence[BlindTrial], temperature: float) -> float:
    """Return the mean log probability of what is hidden."""
    return float(np.mean([np.log(max(of_truth(own, temperature), 1e-6)) for own in trials]))


def best_temperature(trials: Sequence[BlindTrial]) -> float:
    """Return the temperature of the largest log score."""
    return max(TEMPERATURES, key=lambda temperature: log_score(trials, temperature))


@dataclass(frozen=True)
class Claim:
    """Claim of a trial: the likeliest node, nothing or something else, its probability, truth."""

    probability: float
    right: bool


def claim(trial: BlindTrial, temperature: float) -> Claim:
    """Return the likeliest claim of a trial."""
    shares = tempered(trial, temperature)
    held: dict[str, float] = {}
    for share, (_, nodes, unknown, _, _) in zip(shares, trial.explanations, strict=True):
        paths = set(nodes) | ({'?'} if unknown else set())
        for path in paths or {'nothing'}:
            held[path] = held.get(path, 0.0) + float(share)
    path, probability = max(held.items(), key=lambda pair: pair[1])
    if path == 'nothing':
        right = trial.series == 'clean'
    elif path == '?':
        right = trial.series == 'outside'
    else:
        right = holds(path, trial.effects)
    return Claim(min(probability, 1.0), right)


def calibration_error(claims: Sequence[Claim], bins: int = 5) -> float:
    """Return the debiased calibration error (Kumar, Liang & Ma 2019), root of the mean square."""
    order = sorted(claims, key=lambda own: own.probability)
    total = 0.0
    for some in np.array_split(np.arange(len(order)), bins):
        if len(some) < 2:
            continue
        said = float(np.mean([order[place].probability for place in some]))
        was = float(np.mean([order[place].right for place in some]))
        bias = was * (1.0 - was) / (len(some) - 1)
        total += len(some) / len(order) * ((said - was) ** 2 - bias)
    return float(np.sqrt(max(total, 0.0)))


def wrong_at(trial: BlindTrial, temperature: float, cut: float) -> bool:
    """Return True if a leaf or node that does not hold what is hidden reaches a cut."""
    shares = tempered(trial, temperature)
    held: dict[str, float] = {}
    unknown_share = 0.0
    for share, (names, nodes, unknown, _, _) in zip(shares, trial.explanations, strict=True):
        unknown_share += float(share) * bool(unknown)
        for path in {*nodes, *(f'{node}/{name}' for name, node in zip(names, nodes, strict=True))}:
            held[path] = held.get(path, 0.0) + float(share)
    named = [path for path, probability in held.items() if probability >= cut]
    if unknown_share > 0.5:
        return False
    lowest = [path for path in named if not any(own.startswith(f'{path}/') for own in named)]
    return any(not holds(path, trial.effects) for path in lowest)


def certified_cut(trials: Sequence[BlindTrial], temperature: float) -> float | None:
    """Return the lowest cut whose share of wrong names is certified (Learn then Test).

    Cuts are tested from the highest on by the exact binomial test; the first that cannot be
    rejected ends it (fixed sequence; Angelopoulos et al. 2021).
    """
    found = None
    for cut in CUTS:
        wrong = sum(wrong_at(trial, temperature, cut) for trial in trials)
        if binom.cdf(wrong, len(trials), MOST_WRONG) > 1.0 - CONFIDENCE:
            break
        found = cut
    return found
