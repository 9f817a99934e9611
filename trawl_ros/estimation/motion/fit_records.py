# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the fit in motion: its options, and its result."""

from dataclasses import dataclass, field

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimate import NetFactor
from trawl_ros.estimation.motion.nuisances import TowLayout
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow


@dataclass(frozen=True)
class MotionOptions:
    """Options of the fit in motion.

    Attributes
    ----------
    sizes
        Sizes of the errors before the data speak.
    times
        Correlation times of the errors.
    estimate_sizes
        True if sizes are estimated, else they are as they stand.
    nuisances
        True if added mass, errors of inputs and calibration are estimated along; else they are
        known.
    model
        Factor on the constant part of the model's error.
    largest_step
        Largest change of a coefficient in one step, in prior std.
    tolerance
        A step below this part of every coefficient's std is the end.
    iterations, attempts, towings
        At most; attempts at a step that lowers the cost, each damped more; towings of all tows in
        all, or what they cost where no step fails, after which none is begun.
    huber
        Std beyond which a mean counts less; infinite for normal errors.
    """

    sizes: ErrorSizes = field(default_factory=ErrorSizes)
    times: ErrorTimes = field(default_factory=ErrorTimes)
    estimate_sizes: bool = True
    nuisances: bool = True
    model: float = 1.0
    largest_step: float = 1.0
    tolerance: float = 0.1
    iterations: int = 20
    attempts: int = 4
    towings: int = 20
    huber: float = 2.5


@dataclass(frozen=True)
class MotionFit:
    """Fit of tows at one point.

    Attributes
    ----------
    values : (q,) array
        Coefficients.
    matrix : (s, s) array
        Information of the data on the shared parameters, in prior std.
    covariance : (q, q) array
        Posterior covariance of the coefficients.
    parameters : tuple of (p,) arrays
        Of each tow, in units of their prior std.
    linear, data
        Tows as they were linearised last, and their rows.
    sizes
        Sizes of the errors.
    readings
        Number of means in the fit.
    misfit
        Root mean square of the whitened residuals.
    cost
        Half the squares of whitened residuals and of all parameters in prior std.
    iterations
        Steps that were taken.
    converged, reason
        As of an estimate.
    net
        Drag and weight of the net, where these are estimated along.
    """

    values: FloatArray
    matrix: FloatArray
    covariance: FloatArray
    parameters: tuple[FloatArray, ...]
    linear: tuple[LinearisedTow, ...]
    data: LinearData
    layouts: tuple[TowLayout, ...]
    sizes: ErrorSizes
    readings: int
    misfit: float
    cost: float
    iterations: int
    converged: bool
    reason: str
    net: tuple[NetFactor, ...] = ()
