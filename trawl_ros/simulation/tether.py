# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Gear behind a vehicle that somebody else moves: its motion in, forces and shape out."""

import math
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import bar_tensions, points_of
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import cross
from trawl_ros.model.state import Tow
from trawl_ros.records.topics import WINCH_NAMES
from trawl_ros.records.truth import GearPicture
from trawl_ros.simulation.reading import read_picture
from trawl_ros.simulation.ship import Winch
from trawl_ros.solver.equilibrium import find_usable
from trawl_ros.solver.operating_point import OperatingPoint, block_offsets
from trawl_ros.solver.stepper import HALVINGS, StepFailed, Stepper, at_rest


@dataclass(frozen=True)
class VehicleMotion:
    """Motion of the vehicle's origin in ``map`` axes, z up from the surface.

    ``position`` (3,) in m, ``rotation`` (3, 3) from the vehicle's axes (x forward, y port, z up),
    ``velocity`` (3,) over ground in m/s, ``rates`` (3,) of rotation in rad/s.
    """

    position: FloatArray
    rotation: FloatArray
    velocity: FloatArray
    rates: FloatArray


@dataclass(frozen=True)
class Wrench:
    """Force (3,) in N and moment (3,) in N m about the vehicle's origin, in the vehicle's axes."""

    force: FloatArray
    moment: FloatArray


class Tether:
    """Gear towed by a vehicle, from the equilibrium at the vehicle's first motion.

    Parameters
    ----------
    model
        Model from `build_model`.
    vehicle
        First motion. Its heading and horizontal velocity give the equilibrium.
    lengths
        Lengths of the warps, port first, m.
    tow_point
        Point midway between the towing blocks, in the vehicle's axes (3,), m.
    longest_step_s
        Longest time step, s; longer spans are divided.

    Raises
    ------
    NoSteadyState
        If the gear has no usable steady state at this speed.
    """

    def __init__(
        self,
        model: GearModel,
        vehicle: VehicleMotion,
        lengths: tuple[float, float],
        *,
        tow_point: tuple[float, float, float] = (0.0, 0.0, 0.0),
        longest_step_s: float = 0.2,
    ) -> None:
        self.model = model
        self._arms = block_offsets(model, 0.0) + np.array(tow_point)
        self._longest = longest_step_s
        self._winches = Winch(lengths[0], 0.0), Winch(lengths[1], 0.0)
        self.wanted = lengths
        ahead = vehicle.rotation[:, 0]
        heading = math.atan2(ahead[1], ahead[0])
        through_water = vehicle.velocity - model.water.surface_current
        speed = float(through_water @ [math.cos(heading), math.sin(heading), 0.0])
        steady = find_usable(model, OperatingPoint(*lengths, speed, heading)).equilibrium
        self._vehicle = vehicle
        self._tow = self._towed_by(vehicle)
        offset = self._tow.blocks.mean(axis=0)
        self._motion = at_rest(steady.state.shifted(offset))
        self._stepper = Stepper(model)

    def advance(self, vehicle: VehicleMotion, span_s: float) -> None:
        """Advance to the vehicle's motion at the end of a span of time.

        Position and velocity have to belong together: an error of a millimetre between block and
        wire is a kilonewton of tension.

        Raises
        ------
        StepFailed
            If the motion cannot be computed even with short steps.
        """
        port, starboard = self._winches
        limits = self.model.gear.winch
        self._winches = (
            port.advanced(limits, self.wanted[0], span_s),
            starboard.advanced(limits, self.wanted[1], span_s),
        )
        begin, end = self._tow, self._towed_by(vehicle)
        steps = max(1, math.ceil(span_s / self._longest - 1e-9))
        for number in range(1, steps + 1):
            tow = _between(begin, end, span_s, number / steps)
            self._step(tow, span_s / steps, HALVINGS)
        self._vehicle = vehicle

    def stop_winches(self) -> None:
        """Stop the winches where they are."""
        limits = self.model.gear.winch
        port, starboard = self._winches
        self.wanted = port.stop_length(limits), starboard.stop_length(limits)

    def _towed_by(self, vehicle: VehicleMotion) -> Tow:
        arms = self._arms @ vehicle.rotation.T
        port, starboard = self._winches
        return Tow(
            blocks=vehicle.position + arms,
            block_velocities=vehicle.velocity + cross(vehicle.rates, arms),
            lengths=np.array([port.length, starboard.length]),
            length_rates=np.array([port.speed, starboard.speed]),
        )

    def _step(self, end: Tow, span_s: float, halvings: int) -> None:
        try:
            self._motion = self._stepper.step(self._motion, end, span_s)
        except StepFailed:
            if halvings == 0:
                raise
            self._step(_between(self._tow, end, span_s, 0.5), 0.5 * span_s, halvings - 1)
            self._step(end, 0.5 * span_s, halvings - 1)
        self._tow = end

    @property
    def lengths(self) -> tuple[float, float]:
        """Warp lengths paid out, port first, m."""
        return self._winches[0].length, self._winches[1].length

    def block_forces(self) -> FloatArray:
        """Return the forces (2, 3) of the warps on the towing blocks in ``map`` axes, N."""
        state, tow = self._motion.state, self._tow
        points = points_of(self.model, state, tow).positions
        tensions = bar_tensions(self.model, state, tow)
        forces = []
        for wanted in WINCH_NAMES:
            _, warp, bars = next(line for line in self.model.layout.lines if line[0] == wanted)
            along = points[warp[1]] - points[warp[0]]
            forces.append(tensions[bars[0]] * along / np.linalg.norm(along))
        return np.array(forces)

    def wrench(self) -> Wrench:
        """Return force and moment of both warps on the vehicle."""
        forces = self.block_forces() @ self._vehicle.rotation
        return Wrench(forces.sum(axis=0), cross(self._arms, forces).sum(axis=0))

    def picture(self, stamp: int) -> GearPicture:
        """Return a picture of the gear at a stamp (ns), for drawing."""
        return read_picture(self.model, stamp, self._motion.state, self._tow)


def _between(first: Tow, last: Tow, span_s: float, share: float) -> Tow:
    """Return the boundary at a share of a span, on the cubic through positions and velocities."""
    t, h = share, span_s

    def cubic(
        p: FloatArray, q: FloatArray, v: FloatArray, w: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        move = q - p
        place = (
            p + h * t * v + t**2 * (3 * move - h * (2 * v + w)) - t**3 * (2 * move - h * (v + w))
        )
        speed = v + 2 * t / h * (3 * move - h * (2 * v + w))
        return place, speed - 3 * t**2 / h * (2 * move - h * (v + w))

    blocks, velocities = cubic(
        first.blocks, last.blocks, first.block_velocities, last.block_velocities
    )
    lengths, rates = cubic(first.lengths, last.lengths, first.length_rates, last.length_rates)
    return Tow(blocks, velocities, lengths, rates)
