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
    part: Linearised,
    coefficients: FloatArray,
    inputs: FloatArray,
    net: FloatArray | None,
    threshold: float,
) -> bool:
    """True if a window is to be relinearised: readings move by so many std to first order.

    Parameters
    ----------
    part
        The window as it was solved.
    coefficients, inputs, net
        Point of linearisation: (12,), warp lengths and speed (3,), factors on the net's drag and
        weight (2,) or None where these are held.
    threshold
        Standard deviations of a window's mean.
    """
    change = part.by_coefficients @ (coefficients - part.at)
    change += part.by_inputs @ (inputs - part.inputs)
    if net is not None:
        change += part.by_net @ (net - part.net)
    return bool(np.max(np.abs(change) / part.std(1)) > threshold)


def moved(
    fit: Fit,
    aimed: Fit,
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
    coefficients = fit.coefficients + share * (aimed.coefficients - fit.coefficients)
    coefficients = fit.prior.clipped(coefficients)
    windows = []
    for part, ahead in zip(fit.windows, aimed.inputs, strict=True):
        inputs = part.inputs + share * (ahead - part.inputs)
        net = None if aimed.net is None else part.net + share * (aimed.net - part.net)
        if part is fit.windows[-1] or far(part, coefficients, inputs, net, threshold):
            try:
                part = linearise(
                    predictor, observables, part.window, coefficients, (part.state,), inputs, net,
                    even=False,
                )  # fmt: skip
            except NoSteadyState:
                if not spare:
                    raise
                spare -= 1
                continue
        windows.append(part)
    return replace(fit, windows=tuple(windows), coefficients=coefficients)


def with_those_of(fit: Fit, other: Fit) -> tuple[Fit, list[SteadyWindow]]:
    """Fit with the windows of another only, and the windows that it loses by that."""
    kept = {part.window.index for part in other.windows}
    lost = [part.window for part in fit.windows if part.window.index not in kept]
    if not lost:
        return fit, lost
    return replace(fit, windows=tuple(p for p in fit.windows if p.window.index in kept)), lost


def comparable(fit: Fit, other: Fit) -> bool:
    """True if the costs compare: windows relinearised in another fit were well predicted before."""
    return not any(
        part is not old and far(old, fit.coefficients, inputs, fit.net, WELL_KNOWN)
        for part, old, inputs in zip(other.windows, fit.windows, fit.inputs, strict=True)
    )
