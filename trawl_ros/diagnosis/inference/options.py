# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Options of the inference, fitted on trials of development seeds and frozen before scoring."""

from dataclasses import dataclass, field

from trawl_ros.diagnosis.inference.blocks import ErrorSize


@dataclass(frozen=True)
class InferenceOptions:
    """Options of the inference.

    Attributes
    ----------
    temperature
        Log Bayes factors are divided by it.
    cut
        Probability from which a leaf or a node is named; certified by the study.
    errors
        Size of errors that readings do not show.
    unknown_rate
        Prior probability of something that the library does not have.
    tail
        Hypotheses are refitted until the others together hold less than this probability; errors
        alone make a quantity of a repair that fails on held-out tows miss by as much so seldom.
    least_share
        A hypothesis of less probability to first order is not refitted.
    refits
        Largest number of refits.
    grown
        Number of the likeliest hypotheses that are refitted, and to which every other one is added.
    largest_set
        Largest number of causes at once.
    pattern_sizes
        Std of the size of a pattern of something else, in std of a reading, equally likely.
    most_patterns
        Largest number of such patterns.
    sets_with_unknown
        Number of the likeliest refitted sets beside which something else is considered.
    power_quantile
        Normal quantile of the power, 80 %, of detectable sizes.
    """

    temperature: float = 1.5
    cut: float = 0.95
    errors: ErrorSize = field(default_factory=ErrorSize)
    unknown_rate: float = 0.03
    tail: float = 1e-3
    least_share: float = 0.01
    refits: int = 14
    grown: int = 6
    largest_set: int = 3
    pattern_sizes: tuple[float, ...] = (2.0, 8.0)
    most_patterns: int = 25
    sets_with_unknown: int = 3
    power_quantile: float = 0.84
