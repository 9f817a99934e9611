"""Derivatives of F - M a at the end of a step by parameters, all motion held.

Boards' coefficients by the complex step; drag and weight of the net exactly, since forces and mass
are linear in both; an effect's values by forward differences of the gear that it makes, against
the gear as it is, which all of them share.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.model.assembly import board_loads, forces, mass
from trawl_ros.model.bar_pass import add_bar_forces, water_of
from trawl_ros.model.board import own_load_slopes
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.slopes.along import add_forces_along_tow, board_inertia
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.likeness import same_mass, same_observables
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

DIFFERENCE = 1e-5
"""Forward differences by an effect's value are taken over this part of its std. Of all effects that
are watched they are within 6e-7 of central ones; over ten times as much that is 1e-5, and over a
tenth of it rounding takes as much."""


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

    def changed(self, effect: Effect) -> Iterator[tuple[float, GearModel]]:
        """Changes of each of an effect's values, with the gear models that they make."""
        values = self.acting.of(effect).values
        for number, parameter in enumerate(effect.parameters):
            more, size = values.copy(), DIFFERENCE * parameter.std
            more[number] += size
            yield size, self.model(self.acting.having(ActiveEffect(effect, more)))


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


@dataclass(frozen=True)
class EffectPushes:
    """Derivatives (dof, m) of F - M a by the values of effects, of what they do to the gear; and
    names of the effects that change what a gear shows which stays where it is.
    """

    push: FloatArray
    showing: frozenset[str]


def effect_pushes(gear: GearAtPoint, parameters: MotionParameters, end: StepEnd) -> EffectPushes:
    """Derivatives by the values of effects."""
    own, still = parameters.of_effects, _GearAtEnd(gear.model(gear.acting), end)
    found, first = np.zeros((gear.plain.dof, own.stop - own.start)), 0
    showing = set()
    for effect in parameters.effects:
        if type(effect).gear is not Effect.gear:
            for number, (size, model) in enumerate(gear.changed(effect)):
                found[:, first + number] = still.change(model) / size
                if not same_observables(model, still.model):
                    showing.add(effect.name)
        first += len(effect.parameters)
    return EffectPushes(found, frozenset(showing))


@dataclass(frozen=True)
class _GearAtEnd:
    """Gear with the effects that act, and the end of its step."""

    model: GearModel
    end: StepEnd

    def change(self, model: GearModel) -> FloatArray:
        """Change (dof,) of F - M a with another model; boards alone, where they alone differ."""
        other = _differing(model, self.model)
        if not other:
            return np.zeros(model.dof)
        if other == {'board'}:
            own = _differing(model.board, self.model.board)
            if own == {'added_mass'}:
                return self._of_boards(self._inertia_of_boards - self._resisted(model))
            if own == {'bend'}:
                return self._of_boards(self._loaded(model) - self._loads_of_boards)
        changed: FloatArray = self._push(model) - self._own_push
        return changed

    def _of_boards(self, change: FloatArray) -> FloatArray:
        """Change (dof,) of what acts on boards alone, (2, 6)."""
        whole = np.zeros(self.model.dof)
        whole[-12:] = change.ravel()
        return whole

    @cached_property
    def _own_push(self) -> FloatArray:
        return self._push(self.model)

    @cached_property
    def _loads_of_boards(self) -> FloatArray:
        return self._loaded(self.model)

    @cached_property
    def _inertia_of_boards(self) -> FloatArray:
        return self._resisted(self.model)

    @cached_property
    def _inertia(self) -> FloatArray:
        """Mass as data on the pattern, of all gears that are heavy alike."""
        return mass(self.model, self.end.predicted, self.end.tow)

    def _push(self, model: GearModel) -> FloatArray:
        """F - M a (dof,)."""
        end, alike = self.end, same_mass(model, self.model)
        inertia = self._inertia if alike else mass(model, end.predicted, end.tow)
        pull = forces(model, end.state, end.tow)
        left: FloatArray = pull - model.pattern.times(inertia, end.acceleration)
        return left

    def _loaded(self, model: GearModel) -> FloatArray:
        """Boards' own loads (2, 6)."""
        return board_loads(model, self.end.state)

    def _resisted(self, model: GearModel) -> FloatArray:
        """Boards' own inertia times acceleration (2, 6)."""
        return board_inertia(model, self.end.predicted.board_rotations, self.end.acceleration)


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


def _differing(one: 'DataclassInstance', other: 'DataclassInstance') -> set[str]:
    """Names of the fields that two records of one kind do not share."""
    names = (part.name for part in fields(one))
    return {name for name in names if getattr(one, name) is not getattr(other, name)}
