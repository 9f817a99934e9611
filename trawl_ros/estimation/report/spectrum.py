# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Spectrum of information over directions among the coefficients."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimate import NAMED_SHARE
from trawl_ros.estimation.fit.parameters import ParameterVector


@dataclass(frozen=True)
class Spectrum:
    """Spectrum: directions in units of the prior's std, from the best known to the least.

    Attributes
    ----------
    names
        Names (q,) of the coefficients.
    singular : (q,) array
        Of the data's whitened sensitivities: 1 where the data know as much as the prior did.
    directions : (q, q) array
        A unit vector in each row.
    """

    names: tuple[str, ...]
    singular: FloatArray
    directions: FloatArray

    def name(self, row: int) -> str:
        """Names of the coefficients with the largest part in a direction."""
        weights = np.abs(self.directions[row])
        order = np.argsort(-weights)
        named = [self.names[i] for i in order if weights[i] >= NAMED_SHARE]
        return ' with '.join(named or [self.names[order[0]]])


def spectrum(covariance: FloatArray, prior: ParameterVector, prior_weight: float) -> Spectrum:
    """Spectrum of a covariance with the prior's information subtracted.

    With C the covariance in prior std, C⁻¹ = V S² Vᵀ + w I: the eigenvalues of C are
    1/(s² + w), whatever else was eliminated on the way to it.

    Parameters
    ----------
    covariance
        Of the coefficients (q, q).
    prior
        Prior with the std (q,) that is the scale.
    prior_weight
        w: 1 where the prior was used, 0 where not.
    """
    scaled = covariance / np.outer(prior.std, prior.std)
    variances, vectors = np.linalg.eigh(scaled)
    singular = np.sqrt(np.maximum(1.0 / variances - prior_weight, 0.0))
    return Spectrum(prior.names, singular, vectors.T)
