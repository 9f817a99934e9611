"""Base class of effects: physics beyond the model, or an error of an instrument.

Each effect is a small file of this folder. It acts in one or more of three places: on what the
gear is towed with (`Effect.apply_to_inputs`), on the gear and its water (`Effect.gear`), and on
what sensors show of it (`Effect.apply_to_sensors`). All three are pure functions of the effect's
values, so that one implementation serves prediction, sensitivities and simulation.
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
"""So many times further than is common an effect is taken to go where it is estimated."""


@dataclass(frozen=True)
class Parameter:
    """Parameter of an effect: a value that says how strong it is.

    Attributes
    ----------
    name, unit
        Of the number; ``unit`` is empty where it has none.
    neutral
        Value at which the effect vanishes.
    low, high
        Bounds of its possible values; assumed.
    std
        Prior standard deviation about the neutral value, assumed; scales the estimate.
    whole
        True for a share of what is there as a whole, 1, or not at all, 0.

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


@dataclass(frozen=True)
class Situation:
    """Covariates that an effect may depend on beside its values.

    Attributes
    ----------
    inputs
        Port and starboard warp length (m) and speed (m/s), as the instruments have them.
    heading
        ENU yaw, rad, in the axes of the model.
    sense
        1, or -1 where she tows the track the other way, so that a current comes from the other end.
    hours
        Since the tow began.
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
    """Base of all effects; one that is in the catalogue overrides at least one of its methods,
    unless it has no parameters: then it is told from readings, without the model.

    Attributes
    ----------
    name, sentence
        Name in the catalogue, and a description in one sentence.
    parameters
        Its numbers; values are given in their order.
    excited_by
        Inputs that must vary in a trial to make it observable.
    confused_with
        Effects that look much alike in common trials.
    dynamic
        True for an effect that shows only in transients, never in steady tows.
    direct
        Direct check without any tow, in one sentence; empty where there is none.
    instrument
        Instrument whose error it is, where that may have others too; empty for physics.
    causes
        Causes on deck, in the gear or in an instrument that look like this, in one sentence; empty
        where ``sentence`` says it.

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
        """True for one with values that steady tows may show."""
        return bool(self.parameters) and not self.dynamic

    @property
    def neutral(self) -> FloatArray:
        """Values (m,) at which the effect vanishes."""
        return np.array([parameter.neutral for parameter in self.parameters])

    def starts(self, depths: FloatArray) -> tuple[FloatArray, ...]:
        """Start values (m,) for a search, where more than neutral ones are of use.

        Parameters
        ----------
        depths
            Of the lower edge of the net's mouth (n,), m, in the tows at hand.
        """
        return (self.neutral,)

    def is_possible(self, lowest: FloatArray, seabed: FloatArray) -> bool:
        """True unless what is known of the place rules it out.

        Parameters
        ----------
        lowest, seabed
            Depths (n,), m, of the lower edge of the net's mouth and of the water in the tows at
            hand, NaN where no instrument tells them.
        """
        return True

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Apply to inputs: true warp lengths and speed (3,) where instruments show ``inputs``."""
        return inputs

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with the effect applied."""
        return model

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Apply to sensors: readings with the effect's errors."""
        return readings


def sense(heading: float | None) -> float:
    """Course sense on the track: 1 within a quarter turn of east, else -1.

    A current stays where it is when she turns round. Unknown headings are taken to be all the same.
    """
    return 1.0 if heading is None or math.cos(heading) >= 0.0 else -1.0
