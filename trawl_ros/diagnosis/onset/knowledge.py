# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Knowledge of the boards, and of how large errors are, with which a tow is watched."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.foreign import load_json, short
from trawl_ros.core.schema import validated
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.processes import KINDS, ErrorSizes
from trawl_ros.gear.board_parameters import CoefficientsRecord
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.coefficients import COEFFICIENTS

STATED = ErrorSizes()
"""Sizes of the errors as they are stated, before any tow has told more."""

MAX_VARIANCE = 100.0
"""Variance of a coefficient, none of which is larger than 10."""

MAX_SIZE = 1e6
"""Noise density, or factor on the stated size of an error."""


@dataclass(frozen=True)
class Knowledge:
    """Knowledge of a gear and its instruments.

    Attributes
    ----------
    values, covariance
        Coefficients (q,) of the boards, and their covariance (q, q).
    densities
        Noise densities of channels as steady windows show them (`noise_densities`). The scatter of
        readings counts where it is more, or where they are not known.
    sizes
        Sizes of the errors as all of a tow shows them, none below what is stated.
    """

    values: FloatArray
    covariance: FloatArray
    densities: Mapping[str, float] = field(default_factory=dict)
    sizes: ErrorSizes = STATED


def of_gear_file(gear: GearRecord) -> Knowledge:
    """Knowledge by the prior of a gear file."""
    prior = board_prior(gear)
    return Knowledge(prior.start, np.diag(prior.std**2))


def of_identification(path: Path, names: Sequence[str] = COEFFICIENTS) -> Knowledge:
    """Knowledge by an ``identification.json``; errors are as stated where it does not tell them.

    ``names`` are those of the parameters of the boards' law.

    Raises
    ------
    TrawlError
        If the file cannot be read, or has no coefficients with their covariance.
    """
    known: Any = load_json(path, TrawlError)
    try:
        found = {name: float(known['coefficients'][name]['value']) for name in names}
        values = validated(CoefficientsRecord, found, path, TrawlError).array()
        covariance = np.array(known['covariance'], dtype=float)[: len(values), : len(values)]
        if not np.abs(covariance).max() <= MAX_VARIANCE:
            raise ValueError(f'covariance: found a value that is not below {MAX_VARIANCE:g}')
        np.linalg.cholesky(covariance)
        densities = _finite(known.get('noise_densities', {}))
        sizes = _sizes((known.get('chain') or {}).get('sizes', {}))
    except (ValueError, KeyError, TypeError, AttributeError, np.linalg.LinAlgError) as reason:
        raise TrawlError(
            f'{path}: {short(reason)}; expected an identification.json with '
            'coefficients and their covariance, as `trawl identify` writes it'
        ) from reason
    return Knowledge(values, covariance, densities, sizes.no_less_than(STATED))


def _sizes(found: Mapping[str, Any]) -> ErrorSizes:
    """Return sizes by their record; what it does not have is as stated."""
    stated: Any = STATED.record()
    known = {kind: _finite(stated[kind] | found.get(kind, {})) for kind in KINDS}
    sizes: Any = {kind: tuple(known[kind][group] for group in GROUPS) for kind in KINDS}
    return ErrorSizes(**sizes | _finite({'log': found.get('log', STATED.log)}))


def _finite(found: Mapping[str, float]) -> dict[str, float]:
    """Return sizes by name.

    Raises
    ------
    ValueError
        If one is negative, too large or not finite: no innovation would be finite either.
    """
    numbers = {name: float(number) for name, number in found.items()}
    for name, number in numbers.items():
        if not 0.0 <= number <= MAX_SIZE:
            raise ValueError(f'{name} is {number:g}, expected from 0 to {MAX_SIZE:g}')
    return numbers
