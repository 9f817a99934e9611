# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Construction of predictor, window finder and estimator for a gear, with its file's prior."""

from dataclasses import replace

import numpy as np

from trawl_ros.effects.effect_set import effects_of
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.windows.finder import SteadyWindowFinder
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.model.water import build_water
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

NET_STD = 0.2
"""Std of the factors on drag and weight of the net, where these are estimated along; assumed."""


def estimator_options(*, prior: bool = True, net: bool = False) -> EstimatorOptions:
    """Return the estimator options that node and command line share.

    ``prior`` is False without the prior; ``net`` estimates drag and weight of the net along.
    """
    std = NET_STD if net else 0.0
    return EstimatorOptions(prior_weight=float(prior), net_drag=std, net_weight=std)


def board_prior(gear: GearRecord) -> ParameterVector:
    """Prior of the parameters of the board's law in a gear file."""
    known, own = gear.identification, gear.board.parameters
    return ParameterVector(
        start=np.array(known.start),
        std=np.array(known.std),
        low=np.array(known.low),
        high=np.array(known.high),
        groups=(ParameterGroup('coefficients', own.names, own.units),),
    )


def predictor_for(gear: GearRecord) -> Predictor:
    """Predictor of a gear with the effects its file switches on."""
    return Predictor(build_model(gear), effects_of(gear))


def finder_for(gear: GearRecord, options: WindowOptions | None = None) -> SteadyWindowFinder:
    """Finder of steady windows for a gear, whose water turns pressure into depth."""
    return SteadyWindowFinder(build_water(gear).depth, options or WindowOptions())


def identification_for(
    gear: GearRecord,
    *,
    window_options: WindowOptions | None = None,
    estimator_options: EstimatorOptions | None = None,
) -> Identification:
    """Build the identification that node and command line share.

    Parameters
    ----------
    gear
        From `load_gear`: the model as it is believed, not the plant.
    window_options, estimator_options
        Criteria of a steady window; options of the estimator. Of a gear without boards drag and
        weight of the net are estimated in any case.
    """
    if gear.pair is not None:
        # Without boards drag and weight of the net are all that there is to estimate.
        options = estimator_options or EstimatorOptions()
        estimator_options = replace(options, net_drag=NET_STD, net_weight=NET_STD)
    return Identification(
        predictor_for(gear),
        board_prior(gear),
        OBSERVABLES,
        build_water(gear).depth,
        window_options,
        estimator_options,
    )
