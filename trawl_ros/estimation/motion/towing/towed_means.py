"""Means of a stretch that the model is towed along, with derivatives by all that is towed."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import ADDED_MASS
from trawl_ros.estimation.motion.towing.under_way import MotionUnderWay
from trawl_ros.solver.motion.readings import MotionPrediction


@dataclass(frozen=True)
class TowedMeans:
    """Predicted means (k,) of a stretch with their derivatives; those by knots are each input's
    first knot that acts, and the derivatives (k, c) by it and those behind.
    """

    values: FloatArray
    by_coefficients: FloatArray
    by_added_mass: FloatArray
    by_errors: FloatArray
    by_knots: tuple[tuple[int, FloatArray], ...]
    by_motions: FloatArray
    by_net: FloatArray
    by_examined: FloatArray


def average_of(
    tow: MovingTow, stretch: int, motion: MotionUnderWay, instants: list[MotionPrediction]
) -> TowedMeans:
    """Means of a stretch from its instants."""
    weights, parameters = tow.weights[stretch], motion.towed.parameters
    values = np.array([instant.values for instant in instants])
    slopes = np.array([instant.slopes for instant in instants])
    for column in motion.begun_since(stretch * tow.stretch_s):
        # The column of the newest knot was another's until this stretch began.
        slopes[0, :, column] = 0.0
    mean = np.einsum('ki,ikm->km', weights, slopes)
    of_effects, added = mean[:, parameters.of_effects], len(ADDED_MASS.parameters)
    of_inputs = mean[:, parameters.of_inputs]
    by_knots = []
    for knots, _, first in tow.inputs.knot_places:
        acting = knots.acting(motion.time - 1e-6)
        by_knots.append((acting.start, of_inputs[:, [first + k % knots.columns for k in acting]]))
    return TowedMeans(
        values=np.einsum('ki,ik->k', weights, values),
        by_coefficients=mean[:, parameters.of_coefficients],
        by_added_mass=of_effects[:, :added],
        by_errors=of_inputs[:, : len(INPUT_ERRORS)],
        by_knots=tuple(by_knots),
        by_motions=mean[:, parameters.of_motions],
        by_net=mean[:, parameters.of_net],
        by_examined=of_effects[:, added:],
    )
