"""Knowledge of the boards with which a tow is watched."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.coefficients import COEFFICIENTS


@dataclass(frozen=True)
class Knowledge:
    """Coefficients (12,) of the boards as they are known, and their covariance (12, 12)."""

    values: FloatArray
    covariance: FloatArray


def of_gear_file(gear: GearRecord) -> Knowledge:
    """Knowledge by the prior of a gear file."""
    prior = board_prior(gear)
    return Knowledge(prior.start, np.diag(prior.std**2))


def of_identification(path: Path) -> Knowledge:
    """Knowledge by an ``identification.json``.

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
    except (OSError, ValueError, KeyError, TypeError, np.linalg.LinAlgError) as reason:
        raise TrawlError(
            f'{path}: {type(reason).__name__}: {reason}; expected an identification.json with '
            'coefficients and their covariance, as `trawl identify` writes it'
        ) from reason
    return Knowledge(values, covariance)
