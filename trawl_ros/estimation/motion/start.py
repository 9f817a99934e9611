"""Start of a fit in motion: the estimate of the steady windows, with its calibration."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimate import Estimate, TowBias
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.nuisances import TowLayout
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.records.channels import INPUTS


def starting_point(
    estimate: Estimate,
    prior: ParameterVector,
    tow: MovingTow,
    layout: TowLayout,
    numbers: Sequence[int],
) -> FloatArray:
    """Parameters (p,) of a tow, in prior std, at which its fit begins.

    Parameters
    ----------
    estimate
        Of the steady windows.
    prior
        Of the twelve coefficients.
    tow, layout
        The tow.
    numbers
        Its numbers among the tows of the estimate; none where it has no window.
    """
    z = np.zeros(len(layout))
    z[: len(prior)] = prior.departure(estimate.values)
    if layout.net_std and estimate.net:
        z[layout.of_net] = [(factor.value - 1.0) / layout.net_std for factor in estimate.net]
    own = [bias for bias in estimate.tow_biases if bias.tow in numbers]
    z[layout.of_errors] = _input_errors(own, tow)
    return z


def _input_errors(biases: Sequence[TowBias], tow: MovingTow) -> FloatArray:
    """Errors of `INPUT_ERRORS`, in std: the smallest that make up what the windows found."""
    means = np.nanmean(tow.inputs.values, axis=0)
    sizes = np.array(
        [
            error.std * (means[INPUTS.index(error.channel)] if error.relative else 1.0)
            for error in INPUT_ERRORS
        ]
    )
    z = np.zeros(len(INPUT_ERRORS))
    for channel in INPUTS:
        found = [bias.value for bias in biases if bias.channel == channel]
        rows = [i for i, error in enumerate(INPUT_ERRORS) if error.channel == channel]
        if found and rows:
            z[rows] = float(np.mean(found)) * sizes[rows] / np.sum(sizes[rows] ** 2)
    return z
