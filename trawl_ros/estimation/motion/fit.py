# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of tows in motion, and of their steady parts alone."""

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.descent import DescentOptions, descend
from trawl_ros.estimation.least_squares.linear_problem import Place
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.nuisances import TowLayout, layout_of, place_at
from trawl_ros.estimation.motion.search import MotionSearch, OnTow
from trawl_ros.estimation.motion.towing.inputs import without_errors
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.records.channels import INPUTS

NEAR = 0.3
"""Part of every std within which a fit has converged where its step lowers no cost."""

MOST_STANDING_STARTS = 2
"""Number of starts at which boards balance as they are seen to, of a fit of steady parts, or one
without a start, that did not converge."""


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
        Of the coefficients.
    options
        Of the fit.
    start
        Parameters of each tow to begin with, in prior std; all nought where None.
    on_stretch
        Called with the numbers of iteration, tow and stretch.
    """
    layouts = tuple(layout_of(tow, gear, options.model) for tow in tows)
    here = [np.zeros(len(layout)) for layout in layouts] if start is None else list(start)
    found = _fit_from(here, gear, tows, layouts, prior, options, on_stretch)
    # What steady parts have found already is no better known from one attitude.
    known = start is not None and not all(tow.steady_only for tow in tows)
    if found.converged or known:
        return found
    for values in islice(_standing(gear, prior, tows), MOST_STANDING_STARTS):
        here = place_at(values, prior, layouts)
        again = _fit_from(here, gear, tows, layouts, prior, options, on_stretch)
        if again.converged:
            return again
    return found


def _fit_from(
    here: Place,
    gear: TowedGear,
    tows: Sequence[MovingTow],
    layouts: tuple[TowLayout, ...],
    prior: ParameterVector,
    options: MotionOptions,
    on_stretch: OnTow,
) -> MotionFit:
    search = MotionSearch(gear, tows, layouts, prior, options, on_stretch, list(here))
    search.begin()
    limits = DescentOptions(options.iterations, options.attempts, options.tolerance, NEAR)
    rest = descend(search, limits)
    return search.fit(search.sizes, rest.place or search.here, rest)


def _standing(
    gear: TowedGear, prior: ParameterVector, tows: Sequence[MovingTow]
) -> Iterator[FloatArray]:
    """Coefficients with which boards stand as in the first stretch that shows their attitudes."""
    # SciPy's optimisers load slowly, and few fits begin again.
    from trawl_ros.estimation.fit.standing import standing_starts

    tow = tows[0]
    attitudes = [name.endswith(('_pitch', '_roll')) for name in tow.channels]
    known = np.flatnonzero(np.isfinite(tow.means[:, attitudes]).all(axis=1))
    if len(known):
        means = {
            name: value
            for name, value in zip(tow.channels, tow.means[known[0]], strict=True)
            if np.isfinite(value)
        }
        inputs = without_errors(tow.inputs)(float(tow.middles[known[0]])).inputs
        yield from standing_starts(
            gear.model, prior, {**means, **dict(zip(INPUTS, inputs, strict=True))}
        )


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
