"""Gauss-Newton over tows in motion: towed and linearised anew until the estimate is at rest."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from scipy.linalg import cholesky
from scipy.optimize import lsq_linear

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.information import LinearGroup, joined, own_values
from trawl_ros.estimation.motion.nuisances import (
    ADDED_MASS_STD,
    TowLayout,
    columns,
    layout_of,
    linear_part,
    point_of,
)
from trawl_ros.estimation.motion.processes import ErrorSizes, ErrorTimes, group_rows
from trawl_ros.estimation.motion.records import MovingTow
from trawl_ros.estimation.motion.sizes import LinearData, estimated_sizes
from trawl_ros.estimation.motion.towing import LinearisedTow, TowedGear, linearise_tow


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
    iterations, halvings
        At most; halvings of a step that leads to a higher cost.
    """

    sizes: ErrorSizes = field(default_factory=ErrorSizes)
    times: ErrorTimes = field(default_factory=ErrorTimes)
    estimate_sizes: bool = True
    nuisances: bool = True
    model: float = 1.0
    largest_step: float = 1.0
    tolerance: float = 0.05
    iterations: int = 20
    halvings: int = 4


@dataclass(frozen=True)
class MotionFit:
    """Fit of tows at one point.

    Attributes
    ----------
    values : (12,) array
        Coefficients.
    matrix : (s, s) array
        Information of the data on the shared parameters, in prior std.
    covariance : (12, 12) array
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


NEAR = 0.1
"""Part of every std from which a fit is at rest where no step lowers its cost."""

COOLER = 0.4
"""Factor from step to step on the errors of the data while these are taken for too large."""

MOST_ADDED_MASS = 2.0
"""Bound on the boards' added mass, as a part of the cylinder of water around them."""

OnTow = Callable[[int, int, int], None]


def fit_motion(
    gear: TowedGear,
    tows: Sequence[MovingTow],
    prior: ParameterVector,
    options: MotionOptions,
    start: FloatArray | None = None,
    on_stretch: OnTow = lambda iteration, tow, stretch: None,
) -> MotionFit:
    """Fit tows in motion.

    Parameters
    ----------
    gear, tows
        The gear that is towed, and its records.
    prior
        Of the twelve coefficients.
    options
        Of the fit.
    start
        Coefficients (12,) to begin with; the prior's where None.
    on_stretch
        Called with the numbers of iteration, tow and stretch.
    """
    layouts = tuple(layout_of(tow, gear.motions, options.model) for tow in tows)
    shared = layouts[0].shared
    here = [np.zeros(len(layout)) for layout in layouts]
    if start is not None:
        for z in here:
            z[:12] = prior.departure(start)

    needed: list[BoolArray | None] = [None for _ in tows]

    def linearise(at: Sequence[FloatArray], iteration: int) -> tuple[LinearisedTow, ...]:
        found = []
        for number, (tow, layout, z) in enumerate(zip(tows, layouts, at, strict=True)):
            point = point_of(tow, layout, z, prior.start, prior.std)
            then = partial(on_stretch, iteration, number)
            found.append(linearise_tow(gear, tow, point, needed[number], then))
        return tuple(found)

    found_sizes, linear = options.sizes, linearise(here, 0)
    needed[:] = [tow.towed for tow in linear]
    place = here
    reason = f'still moving after {options.iterations} iterations'
    converged, iteration = False, 0
    temper = np.inf
    for iteration in range(1, options.iterations + 1):
        data = linear_data(linear, layouts, here, prior, options)
        if options.estimate_sizes and temper == 1.0:
            found_sizes = estimated_sizes(data, options.sizes, found_sizes)
        # Data much sharper than what is known before would lead a full step to where boards fold.
        temper = max(1.0, min(COOLER * temper, _excess(data, here, found_sizes)))
        sizes = found_sizes.tempered(temper)
        target, std = _step(data, here, prior, sizes, shared, options.largest_step)
        size = float(np.max(np.abs(target[0][:12] - here[0][:12]) / std[:12]))
        if temper == 1.0 and size < options.tolerance:
            converged = True
            reason = (
                f'after {iteration} iterations the step is below {options.tolerance:g} of every std'
            )
            here = target
            break
        moved = None
        cost = _cost(data, here, sizes)
        for halving in range(options.halvings + 1):
            part = 0.5**halving
            there = [z + part * (t - z) for z, t in zip(here, target, strict=True)]
            try:
                tried = linearise(there, iteration)
            except NoSteadyState:
                continue
            new = linear_data(tried, layouts, there, prior, options)
            if _cost(new, there, sizes) <= cost * (1.0 + 1e-9):
                moved = there, tried
                break
        if moved is None and temper > 1.0:
            continue
        if moved is None:
            converged = size < NEAR
            reason = f'no step lowers the cost, {size:.2g} std from rest'
            break
        here, linear = moved
        place = here
        needed[:] = [tow.towed for tow in linear]
    sizes = found_sizes
    data = linear_data(linear, layouts, place, prior, options)
    found = joined(data.information(sizes), data.precisions(sizes.log), shared)
    covariance = np.linalg.inv(found.matrix + np.eye(shared))[:12, :12]
    return MotionFit(
        values=prior.start + prior.std * here[0][:12],
        matrix=found.matrix,
        covariance=covariance * np.outer(prior.std, prior.std),
        parameters=tuple(here),
        linear=linear,
        data=data,
        layouts=layouts,
        sizes=sizes,
        readings=sum(len(group.residual) for groups in data.tows for group in groups),
        misfit=_excess(data, here, sizes),
        cost=_cost(data, here, sizes),
        iterations=iteration,
        converged=converged,
        reason=reason,
    )


def linear_data(
    linear: Sequence[LinearisedTow],
    layouts: Sequence[TowLayout],
    at: Sequence[FloatArray],
    prior: ParameterVector,
    options: MotionOptions,
) -> LinearData:
    """Linearised tows as rows, with residuals of parameters that are all nought."""
    every = []
    for tow, layout, z in zip(linear, layouts, at, strict=True):
        slopes = columns(tow, layout, prior.std)
        if not options.nuisances:
            slopes[..., len(prior) :] = 0.0
        towed = z * (1.0 - linear_part(layout))
        residual = tow.residual + slopes @ towed
        groups = []
        for rows in group_rows(tow.tow, tow.values, tow.tow.noise):
            place = rows.stretches, rows.channels
            groups.append(LinearGroup(rows, slopes[place], residual[place]))
        every.append(tuple(groups))
    logs = tuple(layout.of_log for layout in layouts)
    return LinearData(tuple(every), logs, layouts[0].shared, options.times)


def _step(
    data: LinearData,
    here: Sequence[FloatArray],
    prior: ParameterVector,
    sizes: ErrorSizes,
    shared: int,
    largest: float,
) -> tuple[list[FloatArray], FloatArray]:
    """Gauss-Newton step of all parameters, its coefficients within bounds; and the std (s,) of the
    shared ones, in prior std.
    """
    tows, precisions = data.information(sizes), data.precisions(sizes.log)
    found = joined(tows, precisions, shared)
    information = found.matrix + np.eye(shared)
    triangle = cholesky(information)
    right = np.linalg.solve(triangle.T, found.right)
    low, high = np.full(shared, -np.inf), np.full(shared, np.inf)
    box = prior.box(prior.start + prior.std * here[0][:12], largest)
    low[:12], high[:12] = (prior.departure(edge) for edge in box)
    # Water that goes with a board has no negative mass.
    low[12], high[12] = 0.0, MOST_ADDED_MASS / ADDED_MASS_STD
    common = lsq_linear(triangle, right, (low, high), 'bvls', max_iter=300).x
    target = [
        np.concatenate((common, own_values(tow, precision, common)))
        for tow, precision in zip(tows, precisions, strict=True)
    ]
    return target, np.sqrt(np.diag(np.linalg.inv(information)))


def _cost(data: LinearData, here: Sequence[FloatArray], sizes: ErrorSizes) -> float:
    """Cost of parameters at the place where the tows are linearised."""
    precisions = data.precisions(sizes.log)
    total = 0.5 * float(np.sum(here[0][: data.shared] ** 2))
    for tow, z, precision in zip(data.information(sizes), here, precisions, strict=True):
        total += 0.5 * (tow.square + float(z @ (tow.matrix @ z - 2.0 * tow.right)))
        total += 0.5 * float(np.sum((precision * z**2)[data.shared :]))
    return float(total)


def _excess(data: LinearData, here: Sequence[FloatArray], sizes: ErrorSizes) -> float:
    """Root mean square of the whitened residuals."""
    squares, rows = 0.0, 0
    for groups, tow, z in zip(data.tows, data.information(sizes), here, strict=True):
        squares += tow.square + float(z @ (tow.matrix @ z - 2.0 * tow.right))
        rows += sum(len(group.residual) for group in groups)
    return float(np.sqrt(max(squares, 0.0) / max(rows, 1)))
