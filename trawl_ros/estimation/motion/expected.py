# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of tows by the model alone: what a fit would know, without data."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.nuisances import layout_of, place_at, point_of
from trawl_ros.estimation.motion.search import linear_data
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.lineariser import linearise_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear


def expected_rows(
    gear: TowedGear,
    tows: Sequence[MovingTow],
    prior: ParameterVector,
    coefficients: FloatArray,
    options: MotionOptions,
    on_stretch: Callable[[int], None] = lambda number: None,
) -> tuple[list[LinearisedTow], LinearData]:
    """Tow a gear along tows, with all errors of inputs and sensors at nought.

    Parameters
    ----------
    gear
        The gear that is towed.
    tows
        Their inputs, which means there are, and the noise of these; the values do not count.
    prior, coefficients
        Prior of the coefficients, and these (q,).
    options
        Of the fit.
    on_stretch
        Called after each stretch of a tow, with its number.

    Returns
    -------
    list
        Tows as they are linearised, with means as the model predicts them.
    LinearData
        Their rows.
    """
    layouts = [layout_of(tow, gear, options.model) for tow in tows]
    places = place_at(coefficients, prior, layouts)
    linear = []
    for tow, layout, z in zip(tows, layouts, places, strict=True):
        point = point_of(tow, layout, z, prior.start, prior.std)
        towed = linearise_tow(gear, tow, point, on_stretch=on_stretch)
        means = np.where(np.isfinite(tow.means), towed.values, np.nan)
        linear.append(replace(towed, tow=replace(tow, means=means)))
    noise = [tow.noise for tow in tows]
    return linear, linear_data(linear, layouts, places, prior, options, noise)
