# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Parameter vector of a fit: groups of parameters, with names, units, prior and bounds."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate, pairwise
from typing import Literal

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray, Slice
from trawl_ros.core.errors import GearError

Kind = Literal['coefficients', 'effect', 'pattern', 'calibration', 'model', 'net']

FARTHEST = 3.0
"""Nuisance parameters are taken for no larger than this many std when the model is solved."""


@dataclass(frozen=True)
class ParameterGroup:
    """Group of parameters that stand together: the coefficients of a board, one effect's values.

    Attributes
    ----------
    kind
        Kind of all of them.
    names, units
        One for each; a unit is empty where there is none.
    """

    kind: Kind
    names: tuple[str, ...]
    units: tuple[str, ...]

    def __post_init__(self) -> None:
        if len(self.units) != len(self.names):
            raise ValueError(f'found {len(self.units)} units, expected {len(self.names)}')

    def __len__(self) -> int:
        return len(self.names)


@dataclass(frozen=True)
class ParameterVector:
    """Parameter vector of n values: groups one behind the other, with prior and bounds.

    ``std`` is also the scale against which sensitivities, shrink and condition number are measured.

    Attributes
    ----------
    start, std, low, high : (n,) arrays
        Prior mean, standard deviation and bounds in the units of the groups; ``low < high``,
        ``std > 0`` and the start lies within the bounds. They cannot be written to.
    groups
        In order; those of one kind stand together.

    Raises
    ------
    GearError
        If an array has the wrong length, is not finite or contradicts the others.
    """

    start: FloatArray
    std: FloatArray
    low: FloatArray
    high: FloatArray
    groups: tuple[ParameterGroup, ...]

    def __post_init__(self) -> None:
        for field in ('start', 'std', 'low', 'high'):
            array = np.array(getattr(self, field), dtype=float)
            if array.shape != (len(self),) or not np.all(np.isfinite(array)):
                raise GearError(
                    f'identification.{field} has shape {array.shape} or values that are not '
                    f'finite; expected {len(self)} finite numbers'
                )
            array.flags.writeable = False
            object.__setattr__(self, field, array)
        for i, name in enumerate(self.names):
            if self.std[i] <= 0.0:
                raise GearError(
                    f'identification: the std of {name} is {self.std[i]:g}, expected more than 0'
                )
            if not self.low[i] < self.high[i]:
                raise GearError(
                    f'identification: the bounds of {name} are {self.low[i]:g} to '
                    f'{self.high[i]:g}, expected the lower one first'
                )
            if not self.low[i] <= self.start[i] <= self.high[i]:
                raise GearError(
                    f'identification: the start of {name} is {self.start[i]:g}, expected it '
                    f'within its bounds {self.low[i]:g} to {self.high[i]:g}'
                )

    def __len__(self) -> int:
        return sum(map(len, self.groups))

    @property
    def names(self) -> tuple[str, ...]:
        """Names (n) of all parameters."""
        return tuple(name for group in self.groups for name in group.names)

    @property
    def units(self) -> tuple[str, ...]:
        """Units (n) of all parameters."""
        return tuple(unit for group in self.groups for unit in group.units)

    def blocks(self, kind: Kind) -> tuple[range, ...]:
        """Places of each group of a kind."""
        return tuple(block for group, block in self._placed() if group.kind == kind)

    def slice_of(self, kind: Kind) -> Slice:
        """Slice of all groups of a kind; empty where there is none."""
        blocks = self.blocks(kind)
        return slice(blocks[0].start, blocks[-1].stop) if blocks else slice(0, 0)

    def only(self, kind: Kind) -> 'ParameterVector':
        """Vector of the groups of a kind."""
        own = self.slice_of(kind)
        return ParameterVector(
            self.start[own],
            self.std[own],
            self.low[own],
            self.high[own],
            tuple(group for group in self.groups if group.kind == kind),
        )

    def followed_by(self, other: 'ParameterVector') -> 'ParameterVector':
        """Vector with the groups of another appended."""
        return ParameterVector(
            np.concatenate((self.start, other.start)),
            np.concatenate((self.std, other.std)),
            np.concatenate((self.low, other.low)),
            np.concatenate((self.high, other.high)),
            (*self.groups, *other.groups),
        )

    def departure(self, values: FloatArray) -> FloatArray:
        """Departure (n,) of values from the prior mean, in its std."""
        return (values - self.start) / self.std

    def clipped(self, values: FloatArray) -> FloatArray:
        """Values (n,), cut at the bounds."""
        return np.clip(values, self.low, self.high)

    def box(self, values: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Lower and upper limits (n,) within so many std of values, and within the bounds."""
        size = reach * self.std
        return np.maximum(self.low, values - size), np.minimum(self.high, values + size)

    def on_bounds(self, values: FloatArray) -> tuple[BoolArray, BoolArray]:
        """Flags (n,) of the values that rest on their lower, and on their upper bound."""
        near = 1e-9 * (self.high - self.low)
        return values <= self.low + near, values >= self.high - near

    def unpacked(self, values: FloatArray, kind: Kind) -> Mapping[str, float]:
        """Values of the groups of a kind, by name."""
        own = self.slice_of(kind)
        return dict(zip(self.names[own], map(float, values[own]), strict=True))

    def _placed(self) -> Iterator[tuple[ParameterGroup, range]]:
        ends = accumulate(map(len, self.groups), initial=0)
        for group, (begin, end) in zip(self.groups, pairwise(ends), strict=True):
            yield group, range(begin, end)


def nuisance(*groups: ParameterGroup) -> ParameterVector:
    """Vector of nuisance parameters in std: standard normal, and within `FARTHEST`."""
    number = sum(map(len, groups))
    far = np.full(number, FARTHEST)
    return ParameterVector(np.zeros(number), np.ones(number), -far, far, groups)
