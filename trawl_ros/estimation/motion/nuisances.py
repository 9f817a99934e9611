# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Columns of a linearised tow by all its parameters, each in units of its prior std.

Parameters that all tows share come first: coefficients, added mass, the net's factors where these
are estimated along, and the constant part of the model's error. Those of one tow follow: the
slowest motions with which a part of it may begin, errors of its inputs, those that stay and those
at knots along the way, and calibration errors of its sensors.
"""

from collections.abc import Sequence
from dataclasses import dataclass

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

    @property
    def of_coefficients(self) -> Slice:
        """Slice of the boards' coefficients."""
        return slice(0, self.coefficients)

    @property
    def of_added_mass(self) -> Slice:
        """Slice of the boards' added mass."""
        return slice(self.coefficients, self.coefficients + 1)

    @property
    def of_net(self) -> Slice:
        """Slice of the factors on drag and weight of the net."""
        first = self.of_added_mass.stop
        return slice(first, first + (len(NET) if self.net_std else 0))

    @property
    def of_gear(self) -> int:
        """Number of the parameters of the gear itself, the first of all."""
        return self.of_net.stop

    @property
    def shared(self) -> int:
        """Number of the parameters that all tows share."""
        return self.of_gear + len(GROUPS)

    @property
    def of_model(self) -> Slice:
        """Slice of the constant errors of the model."""
        return slice(self.of_gear, self.shared)

    @property
    def of_starts(self) -> Slice:
        """Slice of the slowest motions with which parts begin."""
        return slice(self.shared, self.shared + self.starts)

    @property
    def of_errors(self) -> Slice:
        """Slice of the errors of the inputs."""
        return slice(self.of_starts.stop, self.of_starts.stop + len(INPUT_ERRORS))

    @property
    def of_knots(self) -> Slice:
        """Slice of the errors of inputs at all knots."""
        return slice(self.of_errors.stop, self.of_errors.stop + sum(n for _, n in self.knots))

    @property
    def of_log(self) -> Slice:
        """Slice of the log's errors at its knots."""
        first = self.of_knots.start
        for channel, number in self.knots:
            if channel == 'speed':
                return slice(first, first + number)
            first += number
        return slice(first, first)

    @property
    def of_calibration(self) -> Slice:
        """Slice of the calibration errors."""
        return slice(self.of_knots.stop, len(self))

    def net(self, z: FloatArray) -> FloatArray:
        """Factors (2,) on drag and weight of the net by parameters (p,) in prior std; 1 if held."""
        return 1.0 + self.net_std * z[self.of_net] if self.net_std else np.ones(len(NET))

    def __len__(self) -> int:
        return self.of_knots.stop + len(channel_errors(self.channels))


def layout_of(tow: MovingTow, gear: TowedGear, model: float) -> TowLayout:
    """Layout of a tow of a gear."""
    knots = tuple((knots.channel, knots.number) for knots in tow.inputs.knots)
    number = len(gear.model.coefficients)
    return TowLayout(number, tow.starts, knots, tow.channels, model, gear.net_std)


def columns(linear: LinearisedTow, layout: TowLayout, prior_std: FloatArray) -> FloatArray:
    """Derivatives (n, k, p) of measured means by all parameters, in units of their prior std."""
    n, k = linear.values.shape
    total = np.zeros((n, k, len(layout)))
    total[..., layout.of_coefficients] = linear.by['coefficients'] * prior_std
    total[..., layout.of_added_mass] = linear.by['added_mass'] * ADDED_MASS_STD
    total[..., layout.of_net] = linear.by['net'] * layout.net_std
    for column, group in enumerate(GROUPS, start=layout.of_model.start):
        for row, name in enumerate(layout.channels):
            if group_of(name) == group:
                values = np.nan_to_num(linear.values[:, row])
                total[:, row, column] = layout.model * model_std(name, values)
    total[..., layout.of_starts] = linear.by['starts'] * START_STD_M
    total[..., layout.of_errors] = linear.by['errors']
    for knots, own, _ in linear.tow.inputs.knot_places:
        total[..., layout.of_knots][..., own] = linear.by[knots.channel] @ knots.root
    for number, error in enumerate(channel_errors(layout.channels)):
        row = layout.channels.index(error.channel)
        values = np.nan_to_num(linear.values[:, row]) if error.relative else np.ones(n)
        total[:, row, layout.of_calibration.start + number] = error.std * values
    return total


def point_of(
    tow: MovingTow, layout: TowLayout, z: FloatArray, start: FloatArray, prior_std: FloatArray
) -> TowedPoint:
    """Point at which to tow, from parameters (p,) in units of their prior std."""
    scaled = z[layout.of_knots]
    drifts = [knots.root @ scaled[own] for knots, own, _ in tow.inputs.knot_places]
    return TowedPoint(
        coefficients=start + prior_std * z[layout.of_coefficients],
        added_mass=float(ADDED_MASS_STD * z[layout.of_added_mass][0]),
        errors=z[layout.of_errors],
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
    for part in (layout.of_model, layout.of_starts, layout.of_calibration):
        flags[part] = True
    return flags
