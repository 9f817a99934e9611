"""Derivatives of F - M a at the end of a step by parameters, all motion held.

Boards' coefficients by the complex step; drag and weight of the net exactly, since forces and mass
are linear in both; an effect's values by central differences of the gear that it makes.
"""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import EffectSet
from trawl_ros.model.assembly import forces, mass
from trawl_ros.model.bar_pass import add_bar_forces, water_of
from trawl_ros.model.board import own_load_slopes
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.slopes.along import add_forces_along_tow, board_inertia
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.likeness import same_mass
from trawl_ros.solver.motion.course import InputPoint, by_values
from trawl_ros.solver.motion.parameters import MotionParameters

if TYPE_CHECKING:
    from _typeshed import DataclassInstance


@dataclass(frozen=True)
class StepEnd:
    """End of a step: state, acceleration (dof,), boundary, and the place ``predicted`` at which the
    step takes the gear's mass.
    """

    state: State
    acceleration: FloatArray
    tow: Tow
    predicted: State


@dataclass(frozen=True)
class GearAtPoint:
    """Gear at one instant: ``plain`` without effects, ``acting``, and the inputs there."""

    plain: GearModel
    acting: EffectSet
    point: InputPoint

    def model(self, acting: EffectSet) -> GearModel:
        """Gear model with effects."""
        return acting.gear(self.plain, self.point.situation)


@dataclass(frozen=True)
class NetLoads:
    """Loads of the net that its factors act on: bars with nothing but their drag, and the mass
    (nodes,) that weighs in water.
    """

    ends: IntArray
    rest: FloatArray
    drag: BarProperties
    heavy: FloatArray


def net_loads(model: GearModel) -> NetLoads:
    """Loads of a gear's net, as `GearModel.with_net` has them."""
    bars = np.flatnonzero(model.net_bars)
    own, nothing = model.bars.chosen(bars), np.zeros(len(bars))
    ends, rest = model.ends[bars], model.rest[bars]
    heavy = 0.5 * rest * (own.mass - model.water.density * own.volume)
    return NetLoads(
        ends,
        rest,
        replace(own, stiffness=nothing, mass=nothing, volume=nothing, bow=nothing),
        np.bincount(ends.ravel(), np.repeat(heavy, 2), model.nodes).astype(float),
    )


def pushes(
    model: GearModel,
    parameters: MotionParameters,
    end: StepEnd,
    boundary: TowSlopes,
    net: NetLoads,
    by_effects: FloatArray,
) -> FloatArray:
    """Derivatives (dof, m) of F - M a by all parameters; by those of the boundary, of F alone.

    Parameters
    ----------
    model
        The gear with its effects, as it was towed.
    parameters
        Of the derivatives.
    end
        End of the step.
    boundary
        Derivatives of the boundary there.
    net
        Loads of the net, `net_loads`.
    by_effects
        Derivatives by effects, `effect_pushes`.
    """
    found = np.zeros((model.dof, len(parameters)))
    add_forces_along_tow(model, end.state, end.tow, boundary, found)
    if parameters.coefficients:
        found[-12:, parameters.of_coefficients] += _by_coefficients(model, end)
    if parameters.net:
        found[:, parameters.of_net] += _by_net(model, net, end)
    found[:, parameters.of_effects] += by_effects
    return found


def effect_pushes(gear: GearAtPoint, parameters: MotionParameters, end: StepEnd) -> FloatArray:
    """Derivatives (dof, m) of F - M a by the values of effects, of what they do to the gear."""
    own, still = parameters.of_effects, _GearAtEnd(gear.model(gear.acting), end)
    found, first = np.zeros((gear.plain.dof, own.stop - own.start)), 0
    for effect in parameters.effects:
        last = first + len(effect.parameters)
        if type(effect).gear is not Effect.gear:
            found[:, first:last] += _by_effect(gear, effect, still)
        first = last
    return found


@dataclass(frozen=True)
class _GearAtEnd:
    """Gear with the effects that act, and the end of its step."""

    model: GearModel
    end: StepEnd

    @cached_property
    def inertia(self) -> FloatArray:
        """Mass as data on the pattern, of all gears that are heavy alike."""
        return mass(self.model, self.end.predicted, self.end.tow)


def _by_coefficients(model: GearModel, end: StepEnd) -> FloatArray:
    """Derivatives (12, 12) of the boards' own loads by the coefficients."""
    state = end.state
    slopes = own_load_slopes(
        model.board,
        model.coefficients,
        OUTWARD,
        state.board_positions,
        state.board_rotations,
        state.board_velocities,
        state.board_rates,
        model.water,
    )
    return slopes.reshape(12, -1)


def _by_net(model: GearModel, net: NetLoads, end: StepEnd) -> FloatArray:
    """Derivatives (dof, 2) by factors on drag and weight in water of the net."""
    n, state = model.nodes, end.state
    drag = np.zeros((n, 3))
    add_bar_forces(
        net.ends,
        state.nodes,
        state.node_velocities,
        net.rest,
        np.zeros_like(net.rest),
        net.drag.columns,
        water_of(model.water),
        drag,
    )
    weight = -net.heavy[:, None] * end.acceleration[: 3 * n].reshape(n, 3)
    weight[:, 2] -= net.heavy * model.water.gravity
    found = np.zeros((model.dof, 2))
    found[: 3 * n] = np.column_stack([drag.ravel(), weight.ravel()])
    return found


def _by_effect(gear: GearAtPoint, effect: Effect, still: _GearAtEnd) -> FloatArray:
    """Derivatives (dof, k) by the values of an effect of what it does to the gear."""
    end = still.end

    def push(acting: EffectSet) -> FloatArray:
        model = gear.model(acting)
        if _differ_in_added_mass(model, still.model):
            load = np.zeros(model.dof)
            turned = end.predicted.board_rotations
            load[-12:] = -board_inertia(model, turned, end.acceleration).ravel()
            return load
        alike = same_mass(model, still.model)
        inertia = still.inertia if alike else mass(model, end.predicted, end.tow)
        pull = forces(model, end.state, end.tow)
        left: FloatArray = pull - model.pattern.times(inertia, end.acceleration)
        return left

    slopes: FloatArray = by_values(gear.acting, effect, push).T
    return slopes


def _differ_in_added_mass(one: GearModel, other: GearModel) -> bool:
    """True if two gears are one but for the added mass of their boards."""
    if any(a is not b for name, a, b in _pairs(one, other) if name != 'board'):
        return False
    return all(a is b for name, a, b in _pairs(one.board, other.board) if name != 'added_mass')


def _pairs(
    one: 'DataclassInstance', other: 'DataclassInstance'
) -> list[tuple[str, object, object]]:
    """Fields of two records of one kind: name and both values."""
    names = [part.name for part in fields(one)]
    return [(name, getattr(one, name), getattr(other, name)) for name in names]
