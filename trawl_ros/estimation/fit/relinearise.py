# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Relinearisation: choice of the windows to solve anew as the estimate moves, and their fit."""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised, linearise
from trawl_ros.estimation.fit.prediction import SteadyPredictor
from trawl_ros.estimation.windows.records import SteadyWindow

WELL_KNOWN = 0.5
"""Range of the first order around a window's solution, in std of a reading."""


def far(
    linear: Linearised,
    coefficients: FloatArray,
    inputs: FloatArray,
    net: FloatArray | None,
    threshold: float,
) -> bool:
    """True if a window is to be relinearised: readings move by so many std to first order.

    Parameters
    ----------
    linear
        The window as it was solved.
    coefficients, inputs, net
        Point of linearisation: (12,), warp lengths and speed (3,), factors on the net's drag and
        weight (2,) or None where these are held.
    threshold
        Standard deviations of a window's mean.
    """
    change = linear.by_coefficients @ (coefficients - linear.at)
    change += linear.by_inputs @ (inputs - linear.inputs)
    if net is not None:
        change += linear.by_net @ (net - linear.net)
    return bool(np.max(np.abs(change) / linear.std(1)) > threshold)


def moved(
    fit: Fit,
    target: Fit,
    share: float,
    threshold: float,
    predictor: SteadyPredictor,
    observables: tuple[str, ...],
    spare: int = 0,
) -> Fit:
    """Fit at this share of the way to another, relinearised where first order would not do.

    The newest window always is, lest many small steps walk out of the steady states. So many
    windows as there are to ``spare`` are left out where they have none.

    Raises
    ------
    NoSteadyState
        If more windows have none there.
    """
    coefficients = fit.coefficients + share * (target.coefficients - fit.coefficients)
    coefficients = fit.prior.clipped(coefficients)
    windows = []
    for linear, ahead in zip(fit.windows, target.inputs, strict=True):
        inputs = linear.inputs + share * (ahead - linear.inputs)
        net = None if target.net is None else linear.net + share * (target.net - linear.net)
        if linear is fit.windows[-1] or far(linear, coefficients, inputs, net, threshold):
            try:
                linear = linearise(
                    predictor, observables, linear.window, coefficients, (linear.state,), inputs,
                    net, even=False,
                )  # fmt: skip
            except NoSteadyState:
                if not spare:
                    raise
                spare -= 1
                continue
        windows.append(linear)
    return replace(fit, windows=tuple(windows), coefficients=coefficients)


def with_those_of(fit: Fit, other: Fit) -> tuple[Fit, list[SteadyWindow]]:
    """Fit with the windows of another only, and the windows that it loses by that."""
    kept = {linear.window.index for linear in other.windows}
    lost = [linear.window for linear in fit.windows if linear.window.index not in kept]
    if not lost:
        return fit, lost
    return replace(fit, windows=tuple(p for p in fit.windows if p.window.index in kept)), lost


def comparable(fit: Fit, other: Fit) -> bool:
    """True if the costs compare: windows relinearised in another fit were well predicted before."""
    return not any(
        linear is not old and far(old, fit.coefficients, inputs, fit.net, WELL_KNOWN)
        for linear, old, inputs in zip(other.windows, fit.windows, fit.inputs, strict=True)
    )
