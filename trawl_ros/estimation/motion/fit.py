# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Fit of tows in motion, and of their steady parts alone."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.descent import DescentOptions, descend
from trawl_ros.estimation.least_squares.linear_problem import Place
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.nuisances import layout_of
from trawl_ros.estimation.motion.search import MotionSearch, OnTow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear

NEAR = 0.3
"""Part of every std within which a fit has converged where its step lowers no cost."""


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
    search = MotionSearch(gear, tows, layouts, prior, options, on_stretch, here)
    search.begin()
    limits = DescentOptions(options.iterations, options.attempts, options.tolerance, NEAR)
    rest = descend(search, limits)
    return search.fit(search.sizes, rest.place or search.here, rest)


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
