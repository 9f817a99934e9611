"""Knowledge of the boards, and of how large errors are, with which a tow is watched."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.fit.error_terms import GROUPS
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.motion.processes import ErrorSizes
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.coefficients import COEFFICIENTS

STATED = ErrorSizes()
"""Sizes of the errors as they are stated, before any tow has told more."""


@dataclass(frozen=True)
class Knowledge:
    """Knowledge of a gear and its instruments.

    Attributes
    ----------
    values, covariance
        Coefficients (12,) of the boards, and their covariance (12, 12).
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


def of_identification(path: Path) -> Knowledge:
    """Knowledge by an ``identification.json``; errors are as stated where it does not tell them.

    Raises
    ------
    TrawlError
        If the file cannot be read, or has no coefficients with their covariance.
    """
    try:
        known = json.loads(path.read_text(encoding='utf-8'))
        values = np.array([float(known['coefficients'][name]['value']) for name in COEFFICIENTS])
        covariance = np.array(known['covariance'], dtype=float)[: len(values), : len(values)]
        np.linalg.cholesky(covariance)
        densities = _finite(known.get('noise_densities', {}))
        found = (known.get('motion') or {}).get('sizes', {})
        sizes = _sizes(found, found.get('log', STATED.log))
    except (
        OSError, ValueError, KeyError, TypeError, AttributeError, np.linalg.LinAlgError
    ) as reason:  # fmt: skip
        raise TrawlError(
            f'{path}: {type(reason).__name__}: {reason}; expected an identification.json with '
            'coefficients and their covariance, as `trawl identify` writes it'
        ) from reason
    return Knowledge(values, covariance, densities, sizes.no_less_than(STATED))


def _sizes(found: Mapping[str, dict[str, float]], log: float) -> ErrorSizes:
    """Sizes by their record; what it does not have is as stated."""

    def of(kind: str, stated: tuple[float, ...]) -> tuple[float, ...]:
        known = _finite(found.get(kind, {}))
        return tuple(known.get(group, size) for group, size in zip(GROUPS, stated, strict=True))

    return ErrorSizes(
        of('noise', STATED.noise), of('drift', STATED.drift), of('model', STATED.model),
        of('state', STATED.state), _finite({'log': log})['log'],
    )  # fmt: skip


def _finite(found: Mapping[str, float]) -> dict[str, float]:
    """Numbers by name.

    Raises
    ------
    ValueError
        If one is not finite: no innovation would be, and nothing ever found.
    """
    numbers = {name: float(number) for name, number in found.items()}
    for name, number in numbers.items():
        if not np.isfinite(number):
            raise ValueError(f'{name} is {number}')
    return numbers
