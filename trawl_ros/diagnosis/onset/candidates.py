# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Candidates for what begins during a tow: the catalogue's effects, and patterns of channels."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.diagnosis.library.drift import Drift, drifts
from trawl_ros.effects.base.effect import WIDE, Effect, Parameter, Readings, Situation
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.motion.stretches import STEADY_ONLY
from trawl_ros.model.gear_model import GearModel
from trawl_ros.records.channels import MEASURED

WATCHED = tuple(name for name in MEASURED if name not in STEADY_ONLY)
"""Channels that are watched."""

GROWING = 'per h'
"""Unit of values that an effect grows with from its onset on."""


@dataclass(frozen=True)
class AtOneHour(Effect):
    """Effect as it is after one hour: by that its growth is known at any time."""

    of: Effect | None = None

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Apply to inputs at one hour."""
        assert self.of is not None
        return self.of.apply_to_inputs(values, inputs, replace(at, hours=1.0))

    def gear(self, values: FloatArray, model: GearModel, at: Situation) -> GearModel:
        """Gear model at one hour."""
        assert self.of is not None
        return self.of.gear(values, model, replace(at, hours=1.0))

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Apply to sensors at one hour."""
        assert self.of is not None
        return self.of.apply_to_sensors(values, readings, replace(at, hours=1.0))


@dataclass(frozen=True)
class OnsetCandidate:
    """Candidate for what has begun: columns of the signatures that belong together.

    Attributes
    ----------
    name
        Of the effect, or of the pattern.
    words
        Meaning of the name.
    columns
        Places of its values among those of all candidates.
    """

    name: str
    words: str
    columns: tuple[int, ...]


@dataclass(frozen=True)
class CandidateTable:
    """Candidates with the effects by whose p values they are told.

    Attributes
    ----------
    effects
        Those whose values the columns are, one behind the other.
    candidates
        Effects and patterns that may be named.
    """

    effects: tuple[Effect, ...]
    candidates: tuple[OnsetCandidate, ...]

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters (p) of the columns."""
        return tuple(own for effect in self.effects for own in effect.parameters)

    @property
    def scale(self) -> FloatArray:
        """Size (p,) to which a value may go, a std about neutral."""
        return WIDE * np.array([own.std for own in self.parameters])

    @property
    def reach(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest departure (p,) from neutral."""
        own = self.parameters
        return (
            np.array([one.low - one.neutral for one in own]),
            np.array([one.high - one.neutral for one in own]),
        )

    @property
    def growing(self) -> BoolArray:
        """Flags (p,) of the values with which an effect grows from its onset on."""
        return np.array([own.unit.endswith(GROWING) for own in self.parameters], np.bool_)

    def at_one_hour(self) -> tuple[Effect, ...]:
        """Effects, those that grow as they are after one hour."""
        return tuple(map(_at_one_hour, self.effects))


def candidate_table(effects: Mapping[str, Effect] | None = None) -> CandidateTable:
    """Candidates of a catalogue, by default the one that there is, and of all channels.

    Of each channel and of both sides together there is an offset and a drift, of counters and log
    a drift: their offsets are effects of the catalogue.
    """
    known = catalogue() if effects is None else effects
    whole = (effect for effect in known.values() if effect.parameters)
    patterns = [drift for drift in drifts() if not set(drift.channels) & set(STEADY_ONLY)]
    every: Sequence[Effect] = (*whole, *patterns)
    return CandidateTable(tuple(every), tuple(_candidates(every)))


def _candidates(effects: Iterable[Effect]) -> Iterable[OnsetCandidate]:
    first = 0
    for effect in effects:
        number = len(effect.parameters)
        if isinstance(effect, Drift):
            words = effect.instrument_in_words
            yield OnsetCandidate(effect.name, f'{words} that drift', (first,))
            if effect.channels:
                name = f'{effect.name.removesuffix("_drift")}_offset'
                yield OnsetCandidate(name, f'{words} that are wrong', (first + 1,))
        else:
            own = tuple(range(first, first + number))
            yield OnsetCandidate(effect.name, effect.sentence.rstrip('.'), own)
        first += number


def _at_one_hour(effect: Effect) -> Effect:
    if not any(own.unit.endswith(GROWING) for own in effect.parameters):
        return effect
    same = {key: getattr(effect, key) for key in Effect.__dataclass_fields__}
    return AtOneHour(**same, of=effect)
