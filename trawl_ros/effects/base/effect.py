# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Base class of effects: physics beyond the model, or an error of an instrument.

An effect acts in one or more of three places: on the inputs, warp lengths and speed
(`Effect.apply_to_inputs`), on the gear and its water (`Effect.gear`), and on the readings of
sensors (`Effect.apply_to_sensors`). All three are pure functions of the effect's values, so that
one implementation serves prediction, sensitivities and simulation.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


Readings = dict[str, float]
"""Readings by the name of the observable, SI."""

WIDE = 5.0
"""Bound of an effect where it is estimated, as a multiple of its common size."""


@dataclass(frozen=True)
class Parameter:
    """Parameter of an effect: a number that says how strong it is.

    Attributes
    ----------
    name, unit
        Name and unit of the number; ``unit`` is empty if it has none.
    neutral
        Value at which the effect vanishes.
    low, high
        Bounds of its possible values; assumed.
    std
        Prior standard deviation about the neutral value, assumed; scales the estimate.
    whole
        True for an all-or-nothing share: it is really 0 or 1.
    strength
        False for a number that alone makes no effect of this kind: a first error without a rate.

    Examples
    --------
    >>> import trawl_ros
    >>> trawl_ros.Parameter('area', 'm²', neutral=0.0, low=0.0, high=40.0, std=10.0).neutral
    0.0
    """

    name: str
    unit: str
    neutral: float
    low: float
    high: float
    std: float
    whole: bool = False
    strength: bool = True


@dataclass(frozen=True)
class Situation:
    """Covariates of an effect, in addition to its values.

    Attributes
    ----------
    inputs
        Port and starboard warp length (m) and speed (m/s), as the instruments show them.
    heading
        ENU yaw of the ship in the axes of the model, rad.
    sense
        1, or -1 if she tows the track the other way, so that a current comes from the other end.
    hours
        Hours since the tow began.
    """

    inputs: tuple[float, float, float]
    heading: float = 0.0
    sense: float = 1.0
    hours: float = 0.0

    @property
    def along(self) -> FloatArray:
        """Unit vector (2,), east and north, of the track."""
        return self.sense * np.array([math.cos(self.heading), math.sin(self.heading)])

    @property
    def across(self) -> FloatArray:
        """Unit vector (2,), east and north, to the left of the track."""
        east, north = self.along
        return np.array([-north, east])

    @property
    def speed(self) -> float:
        """Speed through the water by the log, m/s."""
        return self.inputs[2]


@dataclass(frozen=True)
class Effect:
    """Base of all effects.

    An effect with parameters overrides at least one of the three methods. An effect without
    parameters is found from the readings alone, without the model.

    Attributes
    ----------
    name, sentence
        Name in the catalogue, and a description in one sentence.
    parameters
        Its numbers; values are given in their order.
    excited_by
        Inputs that must vary in a trial to make it observable.
    confused_with
        Effects with similar consequences in common trials.
    dynamic
        True for an effect that shows only in transients, never in steady tows.
    direct
        Direct check without any tow, in one sentence; empty if there is none.
    instrument
        Instrument whose error it is, if that may have other errors too; empty for physics.
    causes
        Causes on deck, in the gear or in an instrument, in one sentence; empty if ``sentence``
        says it.

    Examples
    --------
    >>> import trawl_ros
    >>> class LateLog(trawl_ros.Effect):
    ...     def apply_to_inputs(self, values, inputs, at):
    ...         return inputs + [0.0, 0.0, values[0]]
    >>> late = LateLog(
    ...     name='late_log',
    ...     sentence='The log shows less than the speed through the water.',
    ...     parameters=(trawl_ros.Parameter('less', 'm/s', 0.0, -0.5, 0.5, 0.1),),
    ...     excited_by='speed',
    ... )
    >>> late.neutral
    array([0.])
    """

    name: str
    sentence: str
    parameters: tuple[Parameter, ...]
    excited_by: str
    confused_with: tuple[str, ...] = ()
    dynamic: bool = False
    direct: str = ''
    instrument: str = ''
    causes: str = ''

    @property
    def fitted(self) -> bool:
        """True for an effect with values that steady tows may show."""
        return bool(self.parameters) and not self.dynamic

    @property
    def neutral(self) -> FloatArray:
        """Values (m,) at which the effect vanishes."""
        return np.array([parameter.neutral for parameter in self.parameters])

    def starts(self, depths: FloatArray) -> tuple[FloatArray, ...]:
        """Return start values (m,) for a search; the neutral values are enough for most effects.

        Parameters
        ----------
        depths
            Depths of the lower edge of the net's mouth (n,) in the tows at hand, m.
        """
        return (self.neutral,)

    def is_possible(self, lowest: FloatArray, seabed: FloatArray) -> bool:
        """Return False if the depths of net and water rule the effect out.

        Parameters
        ----------
        lowest, seabed
            Depths (n,), m, of the lower edge of the net's mouth and of the water in the tows at
            hand, NaN where no instrument measures them.
        """
        return True

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the true warp lengths and speed (3,) where instruments show ``inputs``."""
        return inputs

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with the effect applied."""
        return model

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the effect's errors."""
        return readings


def sense(heading: float | None) -> float:
    """Return the sense of a course on the track: 1 within a quarter turn of east, else -1.

    A current does not turn when the ship does. Unknown headings are taken to be all the same.
    """
    return 1.0 if heading is None or math.cos(heading) >= 0.0 else -1.0
