# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Line search along a Gauss–Newton step, with the windows solved anew where it leads."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.gauss_newton import gauss_newton_step
from trawl_ros.estimation.fit.prediction import SteadyPredictor
from trawl_ros.estimation.fit.relinearise import comparable, far, moved, with_those_of
from trawl_ros.estimation.windows.records import SteadyWindow

NEGLIGIBLE_GAIN = 1e-3
"""A step that cannot lower the cost by more than this (half a χ²) is not worth taking."""

SMALL = 2.5
"""Size of such a step, in tolerances, up to which it is not tried: windows would be solved anew for
readings that first order predicts within a fraction of their noise."""

NO_GAIN = 'the step would lower the cost by next to nothing'
NO_STEADY_STATE = 'every further step leads to a gear without a steady state'


@dataclass(frozen=True)
class Step:
    """Step of the estimate, taken or not.

    Attributes
    ----------
    fit
        The fit afterwards; where no step was taken, as before with the noise found on the way.
    size
        Length of the full step in std of the coefficients.
    gain
        Decrease of the cost that the linearised windows promise.
    lost
        Windows that have no steady state there.
    obstacle
        Reason why it was not taken, if there was one.
    needless
        True if there was nothing to be taken.
    """

    fit: Fit
    size: float
    gain: float
    lost: tuple[SteadyWindow, ...] = ()
    obstacle: str | None = None
    needless: bool = False

    @property
    def taken(self) -> bool:
        """True if the estimate has moved."""
        return self.obstacle is None and not self.needless


def line_search(
    fit: Fit,
    predictor: SteadyPredictor,
    observables: tuple[str, ...],
    relinearise: float,
    share: float = 1.0,
    spares: Sequence[int] = (0,),
) -> Step:
    """Go a share of the Gauss–Newton step, and halve it until it lowers the cost.

    Parameters
    ----------
    fit
        The fit before.
    predictor
        The model of the gear.
    observables
        Names of the predictor's values, in their order.
    relinearise
        Windows that move by more, in std of their means, are solved anew.
    share
        Part of the full step to begin with.
    spares
        Numbers of windows that may be set aside for want of a steady state, tried in turn.
    """
    options = fit.options
    low, high = fit.prior.box(fit.coefficients, options.largest_step)
    target = gauss_newton_step(fit, low, high)
    fit = replace(fit, scales=target.scales)
    size = float(np.max(np.abs(target.coefficients - fit.coefficients) / target.std))
    step = Step(fit, size, fit.cost - target.cost)
    known = all(
        not far(window, target.coefficients, inputs, target.net, relinearise)
        for window, inputs in zip(fit.windows, target.inputs, strict=True)
    )
    if size < options.tolerance and known:
        return replace(step, needless=True)
    if size < SMALL * options.tolerance and step.gain < NEGLIGIBLE_GAIN:
        return replace(step, obstacle=NO_GAIN)
    for spare, halving in product(spares, range(options.halvings + 1)):
        if spare and step.obstacle != NO_STEADY_STATE:
            break
        try:
            there = moved(
                fit, target, share * 0.5**halving, relinearise, predictor, observables, spare
            )
        except NoSteadyState:
            step = replace(step, obstacle=NO_STEADY_STATE)
            continue
        left, lost = with_those_of(fit, there)
        # Errors do something else there; whichever way one looks at it, it is to be better.
        better = min(there.cost, there.cost_beside(left)) <= left.cost * (1.0 + 1e-12)
        if better or not comparable(left, there):
            return replace(step, fit=there, lost=tuple(lost), obstacle=None)
        step = replace(step, obstacle='no step lowers the cost')
    return step
