# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effect set: the effects that a gear file switches on, applied one after another."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.effects.base.effect import Effect, Readings, Situation
from trawl_ros.effects.empirical import dictionary
from trawl_ros.effects.registry import catalogue
from trawl_ros.gear.records import EffectRecord, GearRecord

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class ActiveEffect:
    """Effect with its values (m,) in the order of its parameters."""

    effect: Effect
    values: FloatArray

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.name


@dataclass(frozen=True)
class EffectSet:
    """Effect set; each effect is applied to the result of the one before it."""

    effects: tuple[ActiveEffect, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.effects)

    def apply_to_inputs(self, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the true warp lengths and speed (3,) where instruments show ``inputs``."""
        for active in self.effects:
            inputs = active.effect.apply_to_inputs(active.values, inputs, at)
        return inputs

    def gear(self, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with all effects applied."""
        for active in self.effects:
            model = active.effect.gear(active.values, model, at)
        return model

    def apply_to_sensors(self, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the errors of all effects."""
        for active in self.effects:
            readings = active.effect.apply_to_sensors(active.values, readings, at)
        return readings

    @property
    def on_inputs(self) -> bool:
        """True if any effect changes the inputs, warp lengths and speed."""
        plain = Effect.apply_to_inputs
        return any(type(active.effect).apply_to_inputs is not plain for active in self.effects)

    @property
    def on_sensors(self) -> bool:
        """True if any effect changes the readings of sensors."""
        plain = Effect.apply_to_sensors
        return any(type(active.effect).apply_to_sensors is not plain for active in self.effects)

    def of(self, effect: Effect) -> ActiveEffect:
        """Return an effect with its values in this set, neutral if it is absent."""
        same = [active for active in self.effects if active.name == effect.name]
        return same[0] if same else ActiveEffect(effect, effect.neutral)

    def having(self, active: ActiveEffect) -> 'EffectSet':
        """Return the set with one effect replaced by name, or added last."""
        names = [other.name for other in self.effects]
        if active.name not in names:
            return EffectSet((*self.effects, active))
        place = names.index(active.name)
        return EffectSet((*self.effects[:place], active, *self.effects[place + 1 :]))

    def without(self, names: Collection[str]) -> 'EffectSet':
        """Return the set without the named effects."""
        return EffectSet(tuple(active for active in self.effects if active.name not in names))


NO_EFFECTS = EffectSet()


def effects_of(gear: GearRecord) -> EffectSet:
    """Return the effect set of a gear file.

    Raises
    ------
    GearError
        If an effect is unknown or cannot stand in a gear file, or a value is unknown or out of
        bounds.
    """
    return EffectSet(tuple(_active(number, record) for number, record in enumerate(gear.effects)))


def _active(number: int, record: EffectRecord) -> ActiveEffect:
    known: Mapping[str, Effect] = {**catalogue(), **dictionary()}
    key = f'effects.{number}'
    if record.name not in known:
        listed = ', '.join(catalogue())
        raise GearError(f'{key}.name: found {record.name}, expected one of {listed}')
    effect = known[record.name]
    if not effect.parameters:
        raise GearError(
            f'{key}.name: {effect.name} has no values in a gear file, expected it among the faults '
            'of a scenario'
        )
    names = [parameter.name for parameter in effect.parameters]
    for name in record.values:
        if name not in names:
            listed = ', '.join(names)
            raise GearError(f'{key}.values: found {name}, expected {listed} of {effect.name}')
    values = []
    for parameter in effect.parameters:
        value = record.values.get(parameter.name, parameter.neutral)
        if not parameter.low <= value <= parameter.high:
            raise GearError(
                f'{key}.values.{parameter.name}: found {value:g}, expected '
                f'{parameter.low:g} to {parameter.high:g} {parameter.unit}'.rstrip()
            )
        values.append(value)
    return ActiveEffect(effect, np.array(values))
