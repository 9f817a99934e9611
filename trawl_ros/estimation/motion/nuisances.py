# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Columns of a linearised tow by all its parameters, each in units of its prior std.

Parameters that all tows share come first: coefficients, added mass, the net's factors where these
are estimated along, and the constant part of the model's error. Those of one tow follow: the
slowest motions with which a part of it may begin, errors of its inputs, those that stay and those
at knots along the way, and calibration errors of its sensors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, Slice
from trawl_ros.estimation.fit.error_terms import GROUPS, channel_errors, group_of, model_std
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear, TowedPoint
from trawl_ros.solver.motion.parameters import NET

START_STD_M = 10.0
"""Prior std (m) of the slowest motions with which a part of a tow begins; assumed. Seven minutes
after 40 m of warp and 0.3 m/s the slowest was still 15 m."""

ADDED_MASS_STD = 0.5
"""Prior std of the boards' added mass, as a part of the cylinder of water around them: that of
the effect of the catalogue."""


@dataclass(frozen=True)
class TowLayout:
    """Layout of the parameters that a fit of one tow sees: names and slices of their kinds.

    Attributes
    ----------
    coefficients
        Number of coefficients of the boards.
    starts
        Number of slow motions with which its parts may begin.
    knots
        Channel and number of knots of each input's error along the way.
    channels
        Measured channels.
    model
        Std of the model's constant error, as a factor on what is stated; 0 for an exact model.
    net_std
        Prior std of the factors on drag and weight of the net; 0 where these are held.
    """

    coefficients: int
    starts: int
    knots: tuple[tuple[str, int], ...]
    channels: tuple[str, ...]
    model: float = 1.0
    net_std: float = 0.0

    @cached_property
    def slices(self) -> Mapping[str, Slice]:
        """Slice of each kind of parameters.

        They are ``coefficients``, ``added_mass``, ``net`` (factors on its drag and weight),
        ``model`` (constant errors), ``starts`` (slowest motions with which parts begin), ``errors``
        (of the inputs), each input's at its knots by its name, and ``calibration``.
        """
        widths = {
            'coefficients': self.coefficients,
            'added_mass': 1,
            'net': len(NET) if self.net_std else 0,
            'model': len(GROUPS),
            'starts': self.starts,
            'errors': len(INPUT_ERRORS),
            **dict(self.knots),
            'calibration': len(channel_errors(self.channels)),
        }
        ends = pairwise(accumulate(widths.values(), initial=0))
        return {name: slice(*edges) for name, edges in zip(widths, ends, strict=True)}

    @property
    def of_gear(self) -> int:
        """Number of the parameters of the gear itself, the first of all."""
        return self.slices['net'].stop

    @property
    def shared(self) -> int:
        """Number of the parameters that all tows share."""
        return self.slices['model'].stop

    @property
    def of_knots(self) -> Slice:
        """Slice of the errors of inputs at all knots."""
        return slice(self.slices['errors'].stop, self.slices['calibration'].start)

    @property
    def of_log(self) -> Slice:
        """Slice of the log's errors at its knots; empty without any."""
        return self.slices.get('speed', slice(0, 0))

    def net(self, z: FloatArray) -> FloatArray:
        """Factors (2,) on drag and weight of the net by parameters (p,) in prior std; 1 if held."""
        return 1.0 + self.net_std * z[self.slices['net']] if self.net_std else np.ones(len(NET))

    def __len__(self) -> int:
        return self.slices['calibration'].stop


def layout_of(tow: MovingTow, gear: TowedGear, model: float) -> TowLayout:
    """Layout of a tow of a gear."""
    knots = tuple((knots.channel, knots.number) for knots in tow.inputs.knots)
    number = len(gear.model.coefficients)
    return TowLayout(number, tow.starts, knots, tow.channels, model, gear.net_std)


def columns(linear: LinearisedTow, layout: TowLayout, prior_std: FloatArray) -> FloatArray:
    """Derivatives (n, k, p) of measured means by all parameters, in units of their prior std."""
    n, k = linear.values.shape
    own, by = layout.slices, linear.by
    total = np.zeros((n, k, len(layout)))
    total[..., own['coefficients']] = by['coefficients'] * prior_std
    total[..., own['added_mass']] = by['added_mass'] * ADDED_MASS_STD
    total[..., own['net']] = by['net'] * layout.net_std
    total[..., own['starts']] = by['starts'] * START_STD_M
    total[..., own['errors']] = by['errors']
    for knots in linear.tow.inputs.knots:
        total[..., own[knots.channel]] = by[knots.channel] @ knots.root
    values = np.nan_to_num(linear.values)
    for row, name in enumerate(layout.channels):
        column = own['model'].start + GROUPS.index(group_of(name))
        total[:, row, column] = layout.model * model_std(name, values[:, row])
    for column, error in enumerate(channel_errors(layout.channels), own['calibration'].start):
        row = layout.channels.index(error.channel)
        total[:, row, column] = error.std * (values[:, row] if error.relative else 1.0)
    return total


def point_of(
    tow: MovingTow, layout: TowLayout, z: FloatArray, start: FloatArray, prior_std: FloatArray
) -> TowedPoint:
    """Point at which to tow, from parameters (p,) in units of their prior std."""
    own = layout.slices
    drifts = [knots.root @ z[own[knots.channel]] for knots in tow.inputs.knots]
    return TowedPoint(
        coefficients=start + prior_std * z[own['coefficients']],
        added_mass=float(ADDED_MASS_STD * z[own['added_mass']][0]),
        errors=z[own['errors']],
        drifts=np.concatenate((np.zeros(0), *drifts)),
        net=layout.net(z),
    )


def place_at(
    coefficients: FloatArray, prior: ParameterVector, layouts: Sequence[TowLayout]
) -> list[FloatArray]:
    """Parameters (p,) of each tow, in prior std, at coefficients of the boards; others are zero."""
    places = [np.zeros(len(layout)) for layout in layouts]
    for z in places:
        z[: len(prior)] = prior.departure(coefficients)
    return places


def linear_part(layout: TowLayout) -> BoolArray:
    """Flags (p,) of the parameters about whose zero a tow is linearised in any place.

    They are slow motions, calibration and the constant errors of the model.
    """
    flags = np.zeros(len(layout), np.bool_)
    for part in ('model', 'starts', 'calibration'):
        flags[layout.slices[part]] = True
    return flags
