# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Posterior estimate after a window: values, covariance, and undetermined combinations."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.special import stdtrit

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.information import LEAST_PRECISION

DETERMINED_FRACTION = 0.2
DETERMINED_SHRINK = 0.5
NAMED_SHARE = 0.4

UNKNOWN_SINGULAR_SHARE = 1e-7
"""Singular value, over the largest, up to which the data know nothing: rounding makes as much."""


@dataclass(frozen=True)
class Combination:
    """Combination of coefficients that the data do not determine.

    ``names`` have the largest part in it; ``weights`` (q,) is its unit vector in units of
    the prior's std, and ``std`` what the data alone know of it in these units (1 = as much
    as was known before).
    """

    names: tuple[str, ...]
    weights: FloatArray
    std: float

    def __str__(self) -> str:
        return ' with '.join(self.names)


@dataclass(frozen=True)
class Innovation:
    """Innovations: measured minus predicted before the window was used, per channel (SI).

    ``std`` counts the reading, the inputs and the coefficients as they were known;
    ``test_ratio`` is innovation² over (3 std)²: below 0.5 is ordinary, above 1 is beyond
    what the stated errors allow.
    """

    channels: tuple[str, ...]
    values: FloatArray
    stds: FloatArray
    test_ratios: FloatArray


@dataclass(frozen=True)
class TowBias:
    """Calibration error of a channel through one tow; positive where it reads too high.

    ``value``, its ``std`` after the fit and what was ``known`` before (std), in the channel's
    ``unit``, at the channel's mean over the tow.
    """

    tow: int
    channel: str
    unit: str
    value: float
    std: float
    known: float


@dataclass(frozen=True)
class NetFactor:
    """Factor on the gear file's drag, or weight in water, of the net.

    ``value`` with its ``std`` after the fit, and its prior std ``known``.
    """

    what: str
    value: float
    std: float
    known: float


@dataclass(frozen=True)
class Posterior:
    """Posterior of the coefficients from prior and data.

    ``covariance`` (q, q); ``singular`` and ``directions`` of the data's sensitivities scaled
    by the prior's std, in descending order; ``root`` (q, q) times its transpose is the
    covariance in prior std.
    """

    covariance: FloatArray
    singular: FloatArray
    directions: FloatArray
    root: FloatArray

    @property
    def condition_number(self) -> float:
        """Condition number: largest over smallest singular value, infinite where one is zero."""
        smallest = self.singular[-1]
        if smallest <= UNKNOWN_SINGULAR_SHARE * self.singular[0]:
            return float('inf')
        return float(self.singular[0] / smallest)


@dataclass(frozen=True)
class Estimate:
    """Posterior estimate of the q coefficients, in the order of the boards' law.

    Attributes
    ----------
    prior
        Prior of the coefficients.
    revision
        Counts estimates since the last reset.
    stamp
        End (ns) of the newest window.
    windows
        Number of windows; 0 for a whole tow.
    values, covariance
        Estimate (q,) and covariance (q, q). Noise as found and ``birge_ratio`` are in it.
    cost
        Robust cost with the prior; ``objective`` is eq. 35.
    converged, reason
        True if the iteration has converged, and the criterion.
    condition_number
        Of the sensitivities, in units of readings' std per prior std, from the data alone.
    undetermined
        Combinations that the data know less well than the prior did.
    noise_scales
        Group of channels → factor by which residuals say that its stated noise is wrong; a few
        imagined readings as stated steady it, and intervals are set by it.
    tow_biases
        Biases of the instruments of each tow.
    net
        Drag and weight of the net; empty where they are held.
    degrees_of_freedom, confidence
        Degrees of freedom of Student's t; probability of the intervals.
    birge_ratio
        By how much standard deviations are widened, since the readings differ from the model by
        more than all errors known of explain; 1 where they do not.
    innovation
        Of the newest window; None after a fit of all windows together.
    """

    prior: ParameterVector
    revision: int
    stamp: int
    windows: int
    values: FloatArray
    covariance: FloatArray
    cost: float
    converged: bool
    reason: str
    condition_number: float = float('nan')
    undetermined: tuple[Combination, ...] = ()
    noise_scales: Mapping[str, float] = field(default_factory=dict)
    tow_biases: tuple[TowBias, ...] = ()
    net: tuple[NetFactor, ...] = ()
    degrees_of_freedom: float = float('inf')
    confidence: float = 0.95
    birge_ratio: float = 1.0
    objective: float = float('nan')
    innovation: Innovation | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names (q,) of the coefficients."""
        return self.prior.names

    @cached_property
    def std(self) -> FloatArray:
        """Standard deviations (q,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def low(self) -> FloatArray:
        """Lower ends (q,) of the intervals by Student's t, cut at the bounds."""
        return np.maximum(self.values - self._half, self.prior.low)

    @property
    def high(self) -> FloatArray:
        """Upper ends (q,) of the intervals."""
        return np.minimum(self.values + self._half, self.prior.high)

    @property
    def _half(self) -> FloatArray:
        return float(stdtrit(self.degrees_of_freedom, 0.5 + 0.5 * self.confidence)) * self.std

    @property
    def shrink(self) -> FloatArray:
        """1 - std/prior std (q,): 0 where the data said nothing, 1 where they said all."""
        return 1.0 - self.std / self.prior.std

    @property
    def determined(self) -> tuple[bool, ...]:
        """Flags of the coefficients that the data determine.

        Their std is at most 20 % of the value or of the prior's std, whichever is more, and at most
        half the prior's std, so that a narrow prior alone determines nothing.
        """
        scale = np.maximum(np.abs(self.values), self.prior.std)
        well = self.std <= DETERMINED_FRACTION * scale
        well &= self.std <= DETERMINED_SHRINK * self.prior.std
        return tuple(map(bool, well))

    @property
    def active_bounds(self) -> tuple[str, ...]:
        """Bounds the estimate rests on, by name."""
        prior, active = self.prior, []
        at_low, at_high = prior.on_bounds(self.values)
        for i, name in enumerate(prior.names):
            if at_low[i]:
                active.append(f'{name} at its lower bound {prior.low[i]:g}')
            elif at_high[i]:
                active.append(f'{name} at its upper bound {prior.high[i]:g}')
        return tuple(active)

    @property
    def noise_scale(self) -> float:
        """Root mean square of the noise scales of all groups."""
        return float(np.sqrt(np.mean(np.square(list(self.noise_scales.values())))))


def posterior_of(information: FloatArray, prior_std: FloatArray, prior_weight: float) -> Posterior:
    """Posterior covariance and singular directions.

    Parameters
    ----------
    information
        Of the data on the coefficients (q, q), in units of ``prior_std``.
    prior_std
        Standard deviations (q,) of the prior.
    prior_weight
        1 for the prior as stated, 0 for none.
    """
    squares, vectors = np.linalg.eigh(information)
    singular, directions = np.sqrt(np.maximum(squares[::-1], 0.0)), vectors.T[::-1]
    # Where neither data nor prior say anything, the std is a million times the scale.
    root = directions.T / np.sqrt(singular**2 + max(prior_weight, LEAST_PRECISION))
    return Posterior(
        covariance=(root @ root.T) * np.outer(prior_std, prior_std),
        singular=singular,
        directions=directions,
        root=root,
    )


def undetermined(knowledge: Posterior, names: Sequence[str]) -> tuple[Combination, ...]:
    """Directions that the data know less well than the prior, rotated by varimax."""
    weak = knowledge.singular < 1.0
    if not np.any(weak):
        return ()
    basis = _varimax(knowledge.directions[weak].T)
    scaled = knowledge.singular[:, None] * (knowledge.directions @ basis)
    combinations = []
    for column, weights in enumerate(basis.T):
        order = np.argsort(-np.abs(weights))
        among = [names[i] for i in order if abs(weights[i]) >= NAMED_SHARE]
        information = float(scaled[:, column] @ scaled[:, column])
        known = information > (UNKNOWN_SINGULAR_SHARE * knowledge.singular[0]) ** 2
        std = information**-0.5 if known else float('inf')
        combinations.append(Combination(tuple(among or [names[order[0]]]), weights, std))
    return tuple(sorted(combinations, key=lambda combination: -combination.std))


def _varimax(basis: FloatArray) -> FloatArray:
    """Rotate the columns (q, k) of a basis so that each rests on few coefficients.

    Singular vectors of like singular values are arbitrary mixtures; this makes them readable.
    """
    rotated = basis
    previous = 0.0
    for _ in range(200):
        cubed = rotated**3 - rotated * np.mean(rotated**2, axis=0)
        left, size, right = np.linalg.svd(basis.T @ cubed)
        rotated = basis @ (left @ right)
        total = float(size.sum())
        if total <= previous * (1.0 + 1e-10):
            break
        previous = total
    return rotated
