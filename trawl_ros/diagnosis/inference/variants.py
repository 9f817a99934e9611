# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Variants of a hypothesis: which of its values differ, and how far, with their prior.

A cause with several values mostly differs in one of them, and its size is usual or unusual. Both
are mixtures: a variant is one component, normal, cut off at the bounds of what is possible.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtr

from trawl_ros.core.arrays import BoolArray, FloatArray, IntArray
from trawl_ros.diagnosis.inference.marginal import Marginal
from trawl_ros.diagnosis.library.entries import Entry

SIZE_MIXTURE = ((1.0, 0.6), (3.0, 0.4))
"""Std of the size in those of the table, and the share of causes that have it."""

WHOLE_STD = 0.05
"""Std of what is there as a whole or not at all, about the whole."""


@dataclass(frozen=True)
class Variant:
    """Variant of a hypothesis.

    Attributes
    ----------
    places
        Places among the hypothesis' own values of those that differ.
    mean, std, low, high : (k,) arrays
        Normal prior and bounds, in the std of the table, about the start.
    weight
        Logarithm of its share of the hypothesis.
    strength : (k,) array
        True for values that are not 0 together where the cause is there.
    """

    places: tuple[int, ...]
    mean: FloatArray
    std: FloatArray
    low: FloatArray
    high: FloatArray
    weight: float
    strength: BoolArray


def variants_of(entry: Entry, start: FloatArray, *, alone: bool) -> tuple[Variant, ...]:
    """Return the variants of a hypothesis.

    Parameters
    ----------
    entry
        The hypothesis.
    start
        Values (m,) from which it is searched.
    alone
        True if one value may differ alone; False where one is the place of another.
    """
    own = entry.effect.parameters
    single = [place for place in entry.places if own[place].strength]
    choices: list[tuple[tuple[int, ...], float]] = [(entry.places, 1.0)]
    if alone and len(entry.places) > 1:
        share = 0.5 / len(single)
        choices = [(entry.places, 0.5), *(((place,), share) for place in single)]
    found = []
    for places, share in choices:
        chosen = [own[place] for place in places]
        std = np.array([parameter.std for parameter in chosen])
        begin = np.array([start[place] for place in places])
        low = (np.array([parameter.low for parameter in chosen]) - begin) / std
        high = (np.array([parameter.high for parameter in chosen]) - begin) / std
        strength = np.array([parameter.strength for parameter in chosen])
        if any(parameter.whole for parameter in chosen):
            whole = (1.0 - begin) / std
            weight = float(np.log(share))
            found.append(Variant(places, whole, WHOLE_STD / std, low, high, weight, strength))
            continue
        found += [
            Variant(places, np.zeros(len(std)), np.full(len(std), size), low, high,
                    float(np.log(share * part)), strength)
            for size, part in SIZE_MIXTURE
        ]  # fmt: skip
    return tuple(found)


@dataclass(frozen=True)
class Chosen:
    """Values of several hypotheses together, one variant of each; places are absolute.

    ``parts`` are the places, among these values, of the strength of each hypothesis.
    """

    places: tuple[int, ...] = ()
    mean: FloatArray = field(default_factory=lambda: np.zeros(0))
    std: FloatArray = field(default_factory=lambda: np.zeros(0))
    low: FloatArray = field(default_factory=lambda: np.zeros(0))
    high: FloatArray = field(default_factory=lambda: np.zeros(0))
    weight: float = 0.0
    parts: tuple[IntArray, ...] = ()

    def joined(self, block: range, variant: Variant) -> 'Chosen':
        """Return these with a variant of one more hypothesis, whose values stand at a block."""
        return Chosen(
            (*self.places, *(block[place] for place in variant.places)),
            np.concatenate((self.mean, variant.mean)),
            np.concatenate((self.std, variant.std)),
            np.concatenate((self.low, variant.low)),
            np.concatenate((self.high, variant.high)),
            self.weight + variant.weight,
            (*self.parts, len(self.places) + np.flatnonzero(variant.strength)),
        )


def log_factor(found: Marginal, chosen: Chosen) -> float:
    """Return the log Bayes factor of a choice, its weight and the cut of its prior included."""
    factor, mean, covariance = found.posterior(chosen.places, chosen.mean, chosen.std)
    std = np.sqrt(np.diag(covariance))
    inside = _inside(chosen, mean, std) - _inside(chosen, chosen.mean, chosen.std)
    return factor + inside + _moment(chosen, mean, std) + chosen.weight


def _moment(chosen: Chosen, mean: FloatArray, std: FloatArray) -> float:
    """Return the log Bayes factor of a moment prior over the normal one.

    A cause that somebody finds is not of size 0: its prior is the normal one times a² (Johnson and
    Rossell 2010, doi:10.1111/j.1467-9868.2009.00730.x). The factor is the mean of a² after the
    readings over that before, averaged over the strengths of a cause.
    """
    ratio = (mean**2 + std**2) / (chosen.mean**2 + chosen.std**2)
    return sum(float(np.log(np.mean(ratio[part]))) for part in chosen.parts)


def _inside(chosen: Chosen, mean: FloatArray, std: FloatArray) -> float:
    """Return the log probability that each value lies within its bounds."""
    low, high = (chosen.low - mean) / std, (chosen.high - mean) / std
    # The difference of the smaller tails keeps its digits far from the bounds.
    share = np.where(low > 0.0, ndtr(-low) - ndtr(-high), ndtr(high) - ndtr(low))
    return float(np.log(np.maximum(share, 1e-300)).sum())
