"""The sensors on the doors: depth by pressure, inclinometers, acoustic spread."""

import math

import numpy as np

from trawl_ros.instruments.distance import RangeInstrument
from trawl_ros.instruments.instrument import Draws, Instrument
from trawl_ros.instruments.parameters import (
    AttitudeParameters,
    DoorParameters,
    PressureParameters,
    RangeParameters,
)
from trawl_ros.instruments.pressure import PressureAt, PressureInstrument
from trawl_ros.instruments.samples import AttitudeSample, PressureSample, RangeSample, Sample
from trawl_ros.simulation.truth import SIDES, Truth


def pitch_and_roll(orientation: np.ndarray) -> tuple[float, float]:
    """Read pitch (nose down positive) and roll (top to starboard positive) off a pose, rad.

    ``orientation`` is the quaternion (x, y, z, w) of a frame x forward, y port, z up. The
    angles are those against gravity, so the heading does not enter.
    """
    x, y, z, w = np.asarray(orientation, dtype=float) / np.linalg.norm(orientation)
    # The vertical in the frame's own axes is all that an inclinometer feels.
    up = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return math.atan2(-up[0], math.hypot(up[1], up[2])), math.atan2(up[1], up[2])


class DoorPressure:
    """A door's depth sensor. Sees the door's position (3,) in ``map``."""

    def __init__(
        self, side: str, parameters: PressureParameters, pressure_at: PressureAt, draws: Draws
    ) -> None:
        self._sensor = PressureInstrument(
            f'door/{side}/pressure', side, parameters, pressure_at, draws
        )

    def observe(self, position: np.ndarray, stamp: int) -> PressureSample | None:
        """Give a sample where one is due."""
        return self._sensor.observe(-float(position[2]), stamp)


class DoorAttitude(Instrument[np.ndarray, AttitudeSample]):
    """A door's inclinometer. Sees the door's orientation, a quaternion (4,)."""

    def __init__(self, side: str, parameters: AttitudeParameters, draws: Draws) -> None:
        errors = {'pitch': parameters.model(), 'roll': parameters.model()}
        super().__init__(f'door/{side}/attitude', parameters.rate_hz, errors, draws)
        self._side = side

    def _read(self, part: np.ndarray, stamp: int) -> AttitudeSample:
        pitch, roll = pitch_and_roll(part)
        return AttitudeSample(
            stamp,
            self._side,
            self._measure('pitch', pitch, stamp),
            self._measure('roll', roll, stamp),
            self._stated_std('pitch'),
        )


class DoorSpread:
    """The acoustic distance from door to door. Sees the positions of both, port first."""

    def __init__(self, parameters: RangeParameters, draws: Draws) -> None:
        self._sensor = RangeInstrument('door/spread', 'spread', parameters, draws)

    def observe(self, positions: tuple[np.ndarray, np.ndarray], stamp: int) -> RangeSample | None:
        """Give a sample where one is due."""
        port, starboard = positions
        return self._sensor.observe(float(np.linalg.norm(port - starboard)), stamp)


class DoorInstruments:
    """All that measures on the doors; ``pressure`` and ``attitude`` in the order of `SIDES`."""

    def __init__(
        self, parameters: DoorParameters, draws: Draws, *, pressure_at: PressureAt
    ) -> None:
        self.pressure = tuple(
            DoorPressure(side, parameters.pressure, pressure_at, draws) for side in SIDES
        )
        self.attitude = tuple(DoorAttitude(side, parameters.attitude, draws) for side in SIDES)
        self.spread = DoorSpread(parameters.spread, draws)

    def observe(self, truth: Truth) -> list[Sample]:
        """Give the samples that are due."""
        port, starboard = truth.doors
        samples: list[Sample | None] = []
        for door, pressure, attitude in zip(truth.doors, self.pressure, self.attitude, strict=True):
            samples.append(pressure.observe(door.position, truth.stamp))
            samples.append(attitude.observe(door.orientation, truth.stamp))
        samples.append(self.spread.observe((port.position, starboard.position), truth.stamp))
        return [sample for sample in samples if sample is not None]
