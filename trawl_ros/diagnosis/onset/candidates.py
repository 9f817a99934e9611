# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Candidate causes of a change during a tow: effects of the catalogue, and faults of channels.

Each candidate has one or more values, which are the columns (p in all) of the table.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.library.drift import Drift, drifts
from trawl_ros.effects.base.effect import WIDE, Effect, Parameter, Readings, Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.stretches import STEADY_ONLY
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import MEASURED

WATCHED = tuple(name for name in MEASURED if name not in STEADY_ONLY)
"""Channels that are watched for a change."""

GROWTH_UNIT_ENDING = 'per h'
"""End of the unit of a growth rate: such an effect grows linearly from its onset on."""


@dataclass(frozen=True, kw_only=True)
class AtOneHour(Effect):
    """An effect one hour after its onset.

    Growing effects are treated as linear in time. So the response at one hour gives all others.

    Attributes
    ----------
    of
        The effect itself.
    """

    of: Effect

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Apply the effect to inputs (3,), one hour after onset."""
        return self.of.apply_to_inputs(values, inputs, replace(at, hours=1.0))

    def gear(self, values: FloatArray, model: GearModel, at: Situation) -> GearModel:
        """Apply the effect to the gear model, one hour after onset."""
        return self.of.gear(values, model, replace(at, hours=1.0))

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Apply the effect to sensor readings, one hour after onset."""
        return self.of.apply_to_sensors(values, readings, replace(at, hours=1.0))


@dataclass(frozen=True)
class OnsetCandidate:
    """Candidate cause of a change: an effect or a channel fault, with the columns of its values.

    Attributes
    ----------
    name
        Name of the effect or of the channel fault.
    words
        Description for reports.
    columns
        Indices of its values among the p values of the table.
    """

    name: str
    words: str
    columns: tuple[int, ...]


@dataclass(frozen=True)
class CandidateTable:
    """All candidates, and the effects whose p values are the columns.

    Attributes
    ----------
    effects
        Effects, in the order of their columns.
    candidates
        Candidates that may be named. A drift of channels gives two: its rate and its offset.
    """

    effects: tuple[Effect, ...]
    candidates: tuple[OnsetCandidate, ...]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of the p columns."""
        return tuple(parameter for effect in self.effects for parameter in effect.parameters)

    @property
    def scale(self) -> FloatArray:
        """Prior std (p,) of the values about neutral: `WIDE` times their common size."""
        return WIDE * np.array([parameter.std for parameter in self.parameters])

    @property
    def reach(self) -> FloatArray:
        """Bounds (2, p) of the values, low and high, as departures from neutral."""
        bounds = [np.array((one.low, one.high)) - one.neutral for one in self.parameters]
        return np.array(bounds).T

    @property
    def growing(self) -> FloatArray:
        """1 for the growth rates among the values (p,), else 0."""
        return np.array([float(_is_growth_rate(parameter)) for parameter in self.parameters])

    def at_one_hour(self) -> tuple[Effect, ...]:
        """Return the effects, growing ones as they are one hour after their onset."""
        return tuple(map(_at_one_hour, self.effects))


def candidate_table(effects: Mapping[str, Effect] | None = None) -> CandidateTable:
    """Return the candidates from a catalogue of effects and from the faults of all channels.

    Each watched channel, and each pair of port and starboard, may have an offset or a drift. Warp
    counters and log have only a drift here, because their offsets are effects of the catalogue.

    Parameters
    ----------
    effects
        Effects by name; the catalogue if None. Those without parameters are left out.
    """
    known = catalogue() if effects is None else effects
    with_parameters = (effect for effect in known.values() if effect.parameters)
    watched_drifts = [drift for drift in drifts() if not set(drift.channels) & set(STEADY_ONLY)]
    together = (*with_parameters, *watched_drifts)
    return CandidateTable(together, tuple(_candidates(together)))


def _candidates(effects: Iterable[Effect]) -> Iterable[OnsetCandidate]:
    """Yield candidates with the columns of their values, counted through all effects."""
    first = 0
    for effect in effects:
        columns = tuple(range(first, first + len(effect.parameters)))
        if isinstance(effect, Drift):
            # The values of a drift are its rate and the error at its beginning, an offset.
            words = effect.instrument_in_words
            yield OnsetCandidate(effect.name, f'{words} that drift', columns[:1])
            if effect.channels:
                name = f'{effect.name.removesuffix("_drift")}_offset'
                yield OnsetCandidate(name, f'{words} that are wrong', columns[1:])
        else:
            yield OnsetCandidate(effect.name, effect.sentence.rstrip('.'), columns)
        first += len(columns)


def _is_growth_rate(parameter: Parameter) -> bool:
    return parameter.unit.endswith(GROWTH_UNIT_ENDING)


def _at_one_hour(effect: Effect) -> Effect:
    """Return a growing effect as it is one hour after its onset, and others unchanged."""
    if not any(map(_is_growth_rate, effect.parameters)):
        return effect
    same = {key: getattr(effect, key) for key in Effect.__dataclass_fields__}
    return AtOneHour(**same, of=effect)
