# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of F - M a at the end of a step by parameters, all motion held.

Derivatives by the boards' coefficients use the complex step. Those by drag and weight of the net
are exact, because forces and mass are linear in both. Those by an effect's values are forward
differences between the changed gear and the gear as it is.
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
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import BarProperties
from trawl_ros.model.observables import observe
from trawl_ros.model.slopes.along import add_forces_along_tow, board_inertia
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.model_equality import same_mass, same_observables
from trawl_ros.solver.motion.course import InputPoint
from trawl_ros.solver.motion.parameters import MotionParameters
from trawl_ros.solver.sensitivity import coefficient_pushes

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

STD_FRACTION_OF_DIFFERENCES = 1e-5
"""Step of forward differences by an effect's value, as a fraction of its std. For all effects of
the catalogue they agree with central differences to 6e-7. With ten times this step it is 1e-5;
with a tenth of it rounding causes the same error."""


@dataclass(frozen=True)
class StepEnd:
    """End of a step: state, acceleration (dof,) and boundary.

    ``predicted`` is the state at which the step takes the gear's mass.
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
        """Return the gear model with effects."""
        return acting.gear(self.plain, self.point.situation)

    def changed(self, effect: Effect) -> Iterator[tuple[float, GearModel]]:
        """Yield a change of each of an effect's values, with the gear model that it makes."""
        values = self.acting.of(effect).values
        for number, parameter in enumerate(effect.parameters):
            more, size = values.copy(), STD_FRACTION_OF_DIFFERENCES * parameter.std
            more[number] += size
            yield size, self.model(self.acting.having(ActiveEffect(effect, more)))


@dataclass(frozen=True)
class NetLoads:
    """Loads of the net that its factors act on.

    ``drag`` are its bars with nothing but their drag; ``heavy`` (nodes,) is the mass that has
    weight in water, kg.
    """

    ends: IntArray
    rest: FloatArray
    drag: BarProperties
    heavy: FloatArray


def net_loads(model: GearModel) -> NetLoads:
    """Return the loads of a gear's net that `GearModel.with_net` scales."""
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
    """Return derivatives (dof, m) of F - M a by all parameters; by the boundary, of F only.

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
        found[-12:, parameters.of_coefficients] += coefficient_pushes(model, end.state)
    if parameters.net:
        found[:, parameters.of_net] += _by_net(model, net, end)
    found[:, parameters.of_effects] += by_effects
    return found


@dataclass(frozen=True)
class EffectPushes:
    """Derivatives (dof, m) of F - M a by the values of effects.

    ``showing`` names the effects that also change observables of a gear that does not move.
    """

    push: FloatArray
    showing: frozenset[str]


def effect_pushes(gear: GearAtPoint, parameters: MotionParameters, end: StepEnd) -> EffectPushes:
    """Return the derivatives by the values of effects."""
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


def shown_by_effects(
    gear: GearAtPoint, parameters: MotionParameters, names: frozenset[str], state: State, tow: Tow
) -> FloatArray:
    """Return derivatives (n_observables, m) of observables by values of effects, all motion held.

    A thicker wire, for example, pulls with another force at the same stretch. The motion itself
    carries every other change by an effect.

    Parameters
    ----------
    gear
        Gear at this instant.
    parameters
        Parameters of the derivatives.
    names
        Effects that may change observables directly; derivatives by all others are zero.
    state, tow
        State of the gear, and its boundary.
    """
    own = parameters.of_effects
    found, first = np.zeros((len(OBSERVABLES), own.stop - own.start)), 0
    still = observe(gear.model(gear.acting), state, tow).array()
    for effect in parameters.effects:
        if effect.name in names:
            for number, (size, model) in enumerate(gear.changed(effect)):
                found[:, first + number] = (observe(model, state, tow).array() - still) / size
        first += len(effect.parameters)
    return found


@dataclass(frozen=True)
class _GearAtEnd:
    """Gear with the effects that act on it, and the end of its step."""

    model: GearModel
    end: StepEnd

    def change(self, model: GearModel) -> FloatArray:
        """Return the change (dof,) of F - M a with another model, cheaply if only boards differ."""
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
        """Return a change (2, 6) of the loads on boards as one (dof,) of all loads."""
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
        """Mass as data on the pattern, shared by all gears of equal mass."""
        return mass(self.model, self.end.predicted, self.end.tow)

    def _push(self, model: GearModel) -> FloatArray:
        """Return F - M a (dof,)."""
        end, shared = self.end, same_mass(model, self.model)
        inertia = self._inertia if shared else mass(model, end.predicted, end.tow)
        pull = forces(model, end.state, end.tow)
        left: FloatArray = pull - model.pattern.times(inertia, end.acceleration)
        return left

    def _loaded(self, model: GearModel) -> FloatArray:
        """Return the boards' own loads (2, 6)."""
        return board_loads(model, self.end.state)

    def _resisted(self, model: GearModel) -> FloatArray:
        """Return the boards' own inertia times acceleration (2, 6)."""
        return board_inertia(model, self.end.predicted.board_rotations, self.end.acceleration)


def _by_net(model: GearModel, net: NetLoads, end: StepEnd) -> FloatArray:
    """Return derivatives (dof, 2) by factors on drag and weight in water of the net."""
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
    """Return the names of fields that two records of one kind do not share."""
    names = (part.name for part in fields(one))
    return {name for name in names if getattr(one, name) is not getattr(other, name)}
