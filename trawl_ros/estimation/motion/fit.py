# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Levenberg-Marquardt over tows in motion: linearised anew until the estimate is at rest."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.bounded_step import shared_std
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.nuisances import layout_of
from trawl_ros.estimation.motion.search import MotionSearch, OnTow
from trawl_ros.estimation.motion.steps import Place, misfit, step
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear

NEAR = 0.3
"""Part of every std, as it will be stated, from which a fit is at rest where its step lowers no
cost."""

COOLER = 0.4
"""Factor from step to step on the errors of the data while these are taken for too large."""

FINDINGS = 3
"""Towings after which weights and sizes of the errors are found, before they stay; and so do
stretches that are lost."""


def fit_motion(
    gear: TowedGear,
    tows: Sequence[MovingTow],
    prior: ParameterVector,
    options: MotionOptions,
    start: Place | None = None,
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
        Parameters of each tow to begin with, in prior std; all nought where None.
    on_stretch
        Called with the numbers of iteration, tow and stretch.
    """
    layouts = tuple(layout_of(tow, gear, options.model) for tow in tows)
    here = [np.zeros(len(layout)) for layout in layouts] if start is None else list(start)
    search = MotionSearch(gear, tows, layouts, prior, options, on_stretch, here)
    search.begin()
    return _rested(search)


def fit_steady(
    gear: TowedGear,
    tows: Sequence[MovingTow],
    prior: ParameterVector,
    options: MotionOptions,
    start: Place | None = None,
    on_stretch: OnTow = lambda iteration, tow, stretch: None,
) -> MotionFit | None:
    """Fit the steady parts of tows alone: by equilibria, with nothing integrated in time.

    Parameters are those of `fit_motion`, and so is what it returns; None where no tow has a steady
    part.
    """
    if not any(tow.steady.any() for tow in tows):
        return None
    steady = [tow.only_steady() for tow in tows]
    return fit_motion(gear, steady, prior, options, start, on_stretch)


def _rested(search: MotionSearch) -> MotionFit:
    """Fit of a search that has begun, at rest or where it has spent what it may."""
    options, sizes = search.options, search.options.sizes
    reason = f'still moving after {options.iterations} iterations'
    converged, iteration, temper, found = False, 0, np.inf, 0
    for iteration in range(1, options.iterations + 1):
        data = search.data(search.linear, search.here)
        # Data much sharper than what is known before would lead a full step to where boards fold.
        temper = max(1.0, min(COOLER * temper, misfit(data, search.here, sizes)))
        # Weights and sizes that are found anew for ever would keep a fit from its rest, as would
        # stretches that come and go from place to place.
        if temper == 1.0 and found < FINDINGS:
            found += 1
            sizes = search.find(sizes)
            data = search.data(search.linear, search.here)
        now = sizes.tempered(temper)
        target = step(data, search.here, search.prior, now, options.largest_step)
        own = slice(0, len(search.prior))
        std = shared_std(data.information(now), data.precisions(now.log), data.shared)[own]
        size = float(np.max(np.abs(target[0][own] - search.here[0][own]) / std))
        if temper == 1.0 and size < options.tolerance:
            converged = True
            reason = (
                f'after {iteration} iterations the step is below {options.tolerance:g} of every std'
            )
            break
        if search.is_spent:
            reason = f'still moving after {search.towings} towings'
            break
        near = temper == 1.0 and size < NEAR
        attempts, regain = 1 if near else options.attempts, found < FINDINGS
        if not search.advance(now, iteration, attempts, regain=regain) and temper == 1.0:
            converged = near
            reason = f'no step lowers the cost, {size:.2g} std from rest'
            break
    place = search.target(sizes) if converged else search.here
    return search.fit(sizes, place, iteration, converged=converged, reason=reason)
