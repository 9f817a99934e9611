# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Towing boundary of a gear along given inputs, with its derivatives by parameters.

Warp lengths and speed are given as counters and log show them; the effects that act give the true
values. The trapezoidal rule integrates the ship's velocity and its derivatives from step to step.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Situation, sense
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import cross
from trawl_ros.model.state import Tow, TowSlopes
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.operating_point import block_offsets

STD_FRACTION_OF_DIFFERENCES = 1e-4
"""Step of central differences by an effect's value, as a fraction of its std."""

RATE_STEP_S = 0.1
"""Step of differences along the rates of the inputs, s."""


@dataclass(frozen=True)
class InputPoint:
    """Inputs at one instant as instruments show them.

    Attributes
    ----------
    inputs, rates
        Port and starboard warp length (m) and speed (m/s), and their rates of change, both (3,).
    heading, yaw_rate
        ENU yaw (rad) and rate of turn (rad/s).
    hours
        Time since the tow began, h.
    errors, error_rates
        Changes (k, 3) of inputs and rates per unit of each of `MotionParameters.inputs`.
    """

    inputs: FloatArray
    rates: FloatArray
    heading: float = 0.0
    yaw_rate: float = 0.0
    hours: float = 0.0
    errors: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    error_rates: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))

    @cached_property
    def situation(self) -> Situation:
        """Situation of the effects."""
        port, starboard, speed = map(float, self.inputs)
        heading = float(self.heading)
        return Situation((port, starboard, speed), heading, sense(heading), self.hours)


@dataclass(frozen=True)
class ShipWay:
    """Position (3,) of the ship midway between the blocks, and its derivatives (m, 3)."""

    position: FloatArray
    slopes: FloatArray


@dataclass(frozen=True)
class CoursePoint:
    """Towing boundary at one instant, the ship's position and velocity, and their derivatives.

    ``velocity`` (3,) has derivatives ``velocity_slopes`` (m, 3).
    """

    tow: Tow
    slopes: TowSlopes
    way: ShipWay
    velocity: FloatArray
    velocity_slopes: FloatArray


def course_point(
    model: GearModel,
    acting: EffectSet,
    parameters: MotionParameters,
    point: InputPoint,
    before: CoursePoint | None = None,
    h: float = 0.0,
) -> CoursePoint:
    """Return the towing boundary at one instant.

    Parameters
    ----------
    model
        The gear; its surface current adds to the speed through the water.
    acting
        Effects that act on the gear.
    parameters
        Parameters of the derivatives.
    point
        Inputs at this instant.
    before, h
        Boundary ``h`` s earlier; without it the ship is at the origin.
    """
    inputs, rates = _true(acting, point)
    by_inputs, by_rates = _slopes(acting, parameters, point)
    ahead = np.array([np.cos(point.heading), np.sin(point.heading), 0.0])
    velocity = inputs[2] * ahead + model.water.surface_current
    velocity_slopes = by_inputs[:, 2:] * ahead
    way = ShipWay(np.zeros(3), np.zeros((len(parameters), 3)))
    if before is not None:
        way = ShipWay(
            before.way.position + 0.5 * h * (before.velocity + velocity),
            before.way.slopes + 0.5 * h * (before.velocity_slopes + velocity_slopes),
        )
    offsets = block_offsets(model, point.heading)
    tow = Tow(
        blocks=way.position + offsets,
        block_velocities=velocity + cross(np.array([0.0, 0.0, point.yaw_rate]), offsets),
        lengths=inputs[:2],
        length_rates=rates[:2],
    )
    slopes = TowSlopes(
        blocks=np.repeat(way.slopes[:, None], 2, axis=1),
        block_velocities=np.repeat(velocity_slopes[:, None], 2, axis=1),
        lengths=by_inputs[:, :2],
        length_rates=by_rates[:, :2],
    )
    return CoursePoint(tow, slopes, way, velocity, velocity_slopes)


def _true(acting: EffectSet, point: InputPoint) -> tuple[FloatArray, FloatArray]:
    """Return the true inputs and their rates, both (3,)."""
    if not acting.on_inputs:
        return point.inputs, point.rates
    inputs = acting.apply_to_inputs(point.inputs, point.situation)
    return inputs, _along(acting, point, point.rates)


def _along(acting: EffectSet, point: InputPoint, direction: FloatArray) -> FloatArray:
    """Return the change (3,) of the true inputs with a change (3,) of the shown ones."""
    up, down = _neighbours(acting, point, direction)
    change: FloatArray = (up - down) / (2.0 * RATE_STEP_S)
    return change


def _mean_true(acting: EffectSet, point: InputPoint) -> FloatArray:
    """Return the true inputs and their rates (2, 3), from a time step before and after."""
    up, down = _neighbours(acting, point, point.rates)
    return np.array([0.5 * (up + down), (up - down) / (2.0 * RATE_STEP_S)])


def _neighbours(
    acting: EffectSet, point: InputPoint, direction: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the true inputs (3,) a step ahead and behind along a direction of the shown ones."""
    at, step = point.situation, RATE_STEP_S * direction
    up = acting.apply_to_inputs(point.inputs + step, at)
    return up, acting.apply_to_inputs(point.inputs - step, at)


def _slopes(
    acting: EffectSet, parameters: MotionParameters, point: InputPoint
) -> tuple[FloatArray, FloatArray]:
    """Return derivatives (m, 3) of the true inputs and of their rates by the parameters."""
    by_inputs, by_rates = np.zeros((2, len(parameters), 3))
    first = parameters.of_effects.start
    for effect in parameters.effects:
        last = first + len(effect.parameters)
        if type(effect).apply_to_inputs is not Effect.apply_to_inputs:
            changed = by_values(acting, effect, lambda there: _mean_true(there, point))
            by_inputs[first:last], by_rates[first:last] = np.moveaxis(changed, 0, 1)
        first = last
    own = parameters.of_inputs
    by_inputs[own], by_rates[own] = point.errors, point.error_rates
    if acting.on_inputs:
        for slopes in (by_inputs[own], by_rates[own]):
            for number, direction in enumerate(slopes):
                slopes[number] = _along(acting, point, direction)
    return by_inputs, by_rates


def by_values(
    acting: EffectSet, effect: Effect, of: Callable[[EffectSet], FloatArray]
) -> FloatArray:
    """Differentiate a result of an effect set by the k values of one effect: (k, ...).

    Central differences are used. The effect may be absent, which means neutral values.
    """
    active = acting.of(effect)
    slopes = []
    for number, parameter in enumerate(effect.parameters):
        size = STD_FRACTION_OF_DIFFERENCES * parameter.std
        step = size * np.eye(len(active.values))[number]
        up, down = (
            of(acting.having(ActiveEffect(effect, active.values + sign * step)))
            for sign in (1.0, -1.0)
        )
        slopes.append((up - down) / (2.0 * size))
    return np.array(slopes)
