# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameters of board laws: each kind of law has its own names, units and prior."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import Coefficient, Positive
from trawl_ros.records.coefficients import COEFFICIENTS


class StartRecord(Record):
    """Prior of a law's parameters: start values, spread and bounds in the order of the law."""

    start: tuple[Coefficient, ...]
    """Start values."""
    std: tuple[Positive, ...]
    """Standard deviations."""
    low: tuple[float, ...]
    """Lower bounds."""
    high: tuple[float, ...]
    """Upper bounds."""

    @model_validator(mode='after')
    def _starts_within_bounds(self) -> 'StartRecord':
        # `BoardParameters.faults_of_prior` checks the lengths.
        for i, (low, start, high) in enumerate(zip(self.low, self.start, self.high, strict=False)):
            if not low < high or not low <= start <= high:
                raise ValueError(
                    f'number {i + 1}: found low {low}, start {start}, high {high}, expected '
                    'low <= start <= high and low < high'
                )
        return self


class CoefficientsRecord(Record):
    """Values of a law's parameters by name, in the order of the law; angles in radians."""

    model_config = ConfigDict(extra='allow')
    __pydantic_extra__: dict[str, Coefficient] = Field(init=False)

    @property
    def names(self) -> tuple[str, ...]:
        """Names (q,) of the parameters."""
        return tuple(self.__pydantic_extra__)

    def array(self) -> NDArray[np.float64]:
        """Return the values (q,)."""
        return np.array(list(self.__pydantic_extra__.values()))

    def with_values(self, values: Iterable[float]) -> 'CoefficientsRecord':
        """Return the record with other values (q,)."""
        return CoefficientsRecord(**dict(zip(self.names, map(float, values), strict=True)))


@dataclass(frozen=True)
class BoardParameters:
    """Parameters of a board law.

    Attributes
    ----------
    names, units
        One for each of q parameters; a unit is empty if there is none.
    prior
        Prior, and values by its start, of a gear file that states none; None if it must state them.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    prior: StartRecord | None = None

    def __len__(self) -> int:
        return len(self.names)

    @property
    def start(self) -> dict[str, float]:
        """Values by the prior's start, by name; empty without a prior."""
        return {} if self.prior is None else dict(zip(self.names, self.prior.start, strict=True))

    def ordered(self, values: Mapping[str, object]) -> dict[str, object]:
        """Return values in the order of the law; unknown names come last."""
        known = [name for name in self.names if name in values]
        return {name: values[name] for name in dict.fromkeys((*known, *values))}

    def faults_of_values(self, values: CoefficientsRecord) -> Iterator[str]:
        """Yield a sentence on each value that is missing, unknown or out of bounds."""
        found = dict(zip(values.names, values.array(), strict=True))
        listed = ', '.join(self.names)
        for name in found:
            if name not in self.names:
                yield f'coefficients.{name}: unknown key, expected {listed} of this board law'
        for name in self.names:
            if name not in found:
                yield f'coefficients.{name}: missing, expected a number'
        if self.prior is None:
            return
        for name, low, high in zip(self.names, self.prior.low, self.prior.high, strict=True):
            if name in found and not low <= found[name] <= high:
                yield (
                    f'coefficients.{name}: found {found[name]:g} with a law of this kind, expected '
                    f'{low:g} to {high:g}. Delete `coefficients` if they describe another board, '
                    'or delete `law`'
                )

    def faults_of_prior(self, prior: StartRecord) -> Iterator[str]:
        """Yield a sentence on each list of a prior that has another length."""
        for name in StartRecord.model_fields:
            if (number := len(getattr(prior, name))) != len(self):
                yield (
                    f'identification.{name}: found {number} numbers, expected {len(self)}, one for '
                    f'each of {", ".join(self.names)}'
                )


_EQ14_UNITS = tuple('' if name.startswith('c') else '1/rad' for name in COEFFICIENTS)

EQ14 = BoardParameters(COEFFICIENTS, _EQ14_UNITS)
"""Straight lines of eq. 14, in the order of eq. 36."""

CORRECTIONS = StartRecord(
    start=(0.0,) * len(COEFFICIENTS),
    std=(0.3, 0.05, 0.5, 0.2, 0.3, 0.05, 0.2, 0.1, 0.3, 0.05, 0.3, 0.15),
    low=(-2.0, -0.3, -2.0, -1.0, -2.0, -0.5, -2.0, -0.5, -1.0, -0.5, -2.0, -0.5),
    high=(2.0, 0.3, 2.0, 1.0, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5),
)
"""Prior of the corrections to a board's table if the gear file has none; assumed."""

CORRECTED = BoardParameters(COEFFICIENTS, _EQ14_UNITS, CORRECTIONS)
"""Straight lines of eq. 14 that are added to a table."""

HEEL = BoardParameters((*COEFFICIENTS, 'h2', 'h3'), (*_EQ14_UNITS, '', ''))
"""Eq. 14, with changes of C_y^F and C_z^F by the sine of the board's heel."""

_STALL = {
    # name: unit, start, std, low, high
    'lift_slope': ('1/rad', 2.5, 0.8, 0.5, 6.0),
    'zero_lift_angle': ('rad', -0.15, 0.1, -0.5, 0.2),
    'stall_angle': ('rad', 0.42, 0.1, 0.15, 0.9),
    'plate_lift': ('', 0.85, 0.15, 0.3, 1.5),
    'base_drag': ('', 0.1, 0.05, 0.0, 0.5),
    'induced_drag': ('', 0.4, 0.15, 0.0, 1.5),
    'centre_ahead': ('', 0.0, 0.3, -0.8, 0.8),
    'span_force_slope': ('1/rad', 0.0, 0.2, -2.0, 2.0),
    'roll_slope': ('1/rad', 0.0, 0.3, -2.0, 2.0),
    'roll': ('', 0.0, 0.1, -0.5, 0.5),
    'pitch_slope': ('1/rad', 0.0, 0.2, -1.0, 2.0),
}
_units, _start, _std, _low, _high = zip(*_STALL.values(), strict=True)

STALL = BoardParameters(
    tuple(_STALL), _units, StartRecord(start=_start, std=_std, low=_low, high=_high)
)
"""Polar with stall, `trawl_ros.model.board_laws`; the prior is assumed."""

PARAMETERS_OF_KIND: Mapping[str, BoardParameters] = MappingProxyType(
    {'eq14': EQ14, 'table': CORRECTED, 'foil': CORRECTED, 'heel': HEEL, 'stall': STALL}
)
"""Kind of a law in a gear file → its parameters; a board without a law follows eq. 14."""
