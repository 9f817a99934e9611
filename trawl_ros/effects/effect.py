"""What an effect is: physics, or an error of an instrument, that a gear may have beyond the model.

Each effect is a small file of this folder. It acts in one or more of three places: on what the
gear is towed with (`Effect.towed`), on the gear and its water (`Effect.gear`), and on what
sensors show of it (`Effect.shown`). All three are pure functions of the effect's values, so that
one implementation serves prediction, sensitivities and simulation.
"""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.model.gear_model import GearModel

Readings = dict[str, float]
"""What is seen of the gear, by the name of the observable, SI."""


@dataclass(frozen=True)
class Parameter:
    """A number that says how strong an effect is.

    Attributes
    ----------
    name, unit
        Of the number; ``unit`` is empty where it has none.
    neutral
        Its value where the effect is not there.
    low, high
        Between them it is taken to be possible; assumed.
    std
        How far from neutral it is commonly found, assumed; scales what is estimated.
    """

    name: str
    unit: str
    neutral: float
    low: float
    high: float
    std: float


@dataclass(frozen=True)
class Situation:
    """What an effect may depend on beside its values.

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
    def along(self) -> np.ndarray:
        """Unit vector (2,), east and north, of the track."""
        return self.sense * np.array([math.cos(self.heading), math.sin(self.heading)])

    @property
    def across(self) -> np.ndarray:
        """Unit vector (2,), east and north, to the left of the track."""
        east, north = self.along
        return np.array([-north, east])

    @property
    def speed(self) -> float:
        """Through the water as the log has it, m/s."""
        return self.inputs[2]


@dataclass(frozen=True)
class Effect:
    """Base of all effects; one that is in the catalogue overrides at least one of its methods.

    Attributes
    ----------
    name, sentence
        What it is called, and what it is, in one sentence.
    parameters
        Its numbers; values are given in their order.
    excited_by
        What must vary in a trial to show it.
    confused_with
        Effects that look much alike in common trials.
    dynamic
        Whether it shows only while something changes, and never in steady tows.
    direct
        How it can be seen without any tow, in one sentence; empty where it cannot.
    instrument
        Whose error it is, where that may have others too; empty where it is no such error.
    """

    name: str
    sentence: str
    parameters: tuple[Parameter, ...]
    excited_by: str
    confused_with: tuple[str, ...] = ()
    dynamic: bool = False
    direct: str = ''
    instrument: str = ''

    @property
    def neutral(self) -> np.ndarray:
        """Values (m,) with which it does nothing."""
        return np.array([parameter.neutral for parameter in self.parameters])

    def starts(self, depths: np.ndarray) -> tuple[np.ndarray, ...]:
        """Values (m,) around which to look for it, where more than neutral ones are of use.

        Parameters
        ----------
        depths
            Of the net (n,), m, in the tows at hand.
        """
        return (self.neutral,)

    def towed(self, values: np.ndarray, inputs: np.ndarray, at: Situation) -> np.ndarray:
        """Warp lengths and speed (3,) the gear is towed with where instruments show ``inputs``."""
        return inputs

    def gear(self, values: np.ndarray, model: GearModel, at: Situation) -> GearModel:
        """The gear with the effect in it."""
        return model

    def shown(self, values: np.ndarray, readings: Readings, at: Situation) -> Readings:
        """What sensors show where the gear is as ``readings`` have it."""
        return readings


def sense(heading: float | None) -> float:
    """Which way a ship goes on her track: 1 within a quarter turn of east, else -1.

    A current stays where it is when she turns round. Unknown headings are taken to be all the same.
    """
    return 1.0 if heading is None or math.cos(heading) >= 0.0 else -1.0
