# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Options of the estimator."""

from dataclasses import dataclass, fields

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError

MAY_BE_ZERO = (
    'prior_weight', 'state_share', 'model_error', 'model_trend', 'unsettled', 'net_drag',
    'net_weight', 'second_start', 'set_aside', 'standing_states',
)  # fmt: skip


@dataclass(frozen=True)
class EstimatorOptions:
    """Options of the estimator.

    Attributes
    ----------
    huber
        Standard deviations from where a reading's pull no longer grows (1.345 keeps 95 % of
        the efficiency on normal noise).
    confidence
        Probability of the intervals.
    prior_weight
        1 uses the prior as stated, 0 leaves it out.
    stated_noise_readings
        Number of imagined readings that speak for the stated noise when the noise is found.
    alike_readings
        Number of imagined readings of a channel group that speak for the noise being wrong by the
        same factor in all of them.
    least_noise
        Noise is never taken to be less than this part of what is stated.
    state_share
        Fraction of the std of a channel's bias that changes from one steady state to the next, if
        the channel table has no measured value (`Channel.state_std`). The rest stays constant
        through the tow. 0: nothing changes with the state.
    model_error
        Factor on the errors of the model; 0 for an exact model.
    model_trend
        Change of these errors, in std, if warps are `LONGER` times as long.
    unsettled
        Std of the remaining change of depth in a steady window, as a fraction of the net's depth.
    net_drag, net_weight
        Std of factors on drag and weight in water of the net, which are then estimated along; where
        both are 0 the net is held as the gear file has it.
    iterations_per_window, iterations_final
        Steps at most after each window and at the end.
    attempts
        Attempts at a step that lowers the cost, each shorter, before giving up.
    largest_step
        Largest change of a coefficient in one step, in prior std.
    relinearise, relinearise_final
        A window is solved again when a predicted reading has moved by this many std, on the
        way and at the end.
    set_aside
        Part of the windows that are left out where they have no steady state on the way, and taken
        back at the end. Where an effect is missing a single one would hold up all the rest.
    tolerance
        A step below this part of every coefficient's std is the end.
    second_start
        True if a fit with a large misfit, or one that does not converge, is repeated from the
        prior's start.
    standing_states
        Number of steady states at which boards that fall at the prior's start are made to stand as
        they are seen to.
    """

    huber: float = 1.345
    confidence: float = 0.95
    prior_weight: float = 1.0
    stated_noise_readings: float = 4.0
    alike_readings: float = 12.0
    least_noise: float = 0.3
    state_share: float = 0.3
    model_error: float = 1.0
    model_trend: float = 0.0
    unsettled: float = 0.05
    net_drag: float = 0.0
    net_weight: float = 0.0
    iterations_per_window: int = 1
    iterations_final: int = 40
    attempts: int = 7
    largest_step: float = 1.0
    relinearise: float = 2.0
    relinearise_final: float = 0.02
    set_aside: float = 0.0
    tolerance: float = 0.02
    second_start: bool = True
    standing_states: int = 3

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not value >= 0.0 or (value == 0.0 and field.name not in MAY_BE_ZERO):
                raise TrawlError(f'{field.name} is {value}, expected a positive number')
        for name in ('confidence', 'state_share', 'set_aside'):
            if not (value := getattr(self, name)) < 1.0:
                raise TrawlError(f'{name} is {value}, expected a number below 1')

    @property
    def net_std(self) -> FloatArray:
        """Prior std of the net's factors (2,) on drag and weight."""
        return np.array([self.net_drag, self.net_weight])

    @property
    def tow_share(self) -> float:
        """Part of a bias in std that stays through the tow."""
        return float(np.sqrt(1.0 - self.state_share**2))
