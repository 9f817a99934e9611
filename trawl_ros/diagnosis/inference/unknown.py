# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""H?: something that no hypothesis of the library is, as smooth functions of few quantities.

Each pattern is the residual of one channel that follows warp length, speed, time or course, with
a normal prior on its size. Patterns are added one at a time; each costs its prior odds.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.inference.marginal import Marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions


@dataclass(frozen=True)
class Unknown:
    """Patterns that explain what is left: log Bayes factor with all priors, places and sizes."""

    log_factor: float
    places: tuple[int, ...]
    sizes: tuple[float, ...]


def unknown(found: Marginal, options: InferenceOptions) -> Unknown:
    """Add patterns while they explain more than they cost.

    Parameters
    ----------
    found
        Marginal of the sizes of all patterns.
    options
        Sizes and largest number of patterns.
    """
    number = len(found.score)
    if number == 0:
        return Unknown(-np.inf, (), ())
    total = 0.0
    places: list[int] = []
    stds: list[float] = []
    path: list[float] = []
    here = found
    for _ in range(min(options.most_patterns, number)):
        factors = np.array([_factors(here, size) for size in options.pattern_sizes])
        factors[:, places] = -np.inf
        each = logsumexp(factors, axis=0) - np.log(len(options.pattern_sizes) * number)
        place = int(np.argmax(each))
        if places and each[place] <= 0.0:
            break
        total += float(each[place])
        path.append(total)
        size = options.pattern_sizes[int(np.argmax(factors[:, place]))]
        here = here.given([place], np.zeros(1), np.array([size]))
        places.append(place)
        stds.append(size)
    _, mean, _ = found.posterior(places, np.zeros(len(places)), np.array(stds))
    return Unknown(float(logsumexp(path)), tuple(places), tuple(map(float, mean)))


def _factors(found: Marginal, size: float) -> FloatArray:
    """Log Bayes factor of each pattern alone."""
    information = np.diag(found.information)
    inner = 1.0 + size**2 * information
    factors: FloatArray = 0.5 * size**2 * found.score**2 / inner - 0.5 * np.log(inner)
    return factors
