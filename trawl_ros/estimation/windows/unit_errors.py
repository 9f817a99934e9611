# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Wrong units of instruments, and the factors by which they change a value."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.units import UNITS
from trawl_ros.records.channels import CHANNELS, INPUTS, Channel

WRONG_UNITS: Mapping[str, Mapping[str, float]] = {
    unit: {UNITS[wrong].name: 1.0 / UNITS[wrong].size for wrong in mistaken}
    for unit, mistaken in {
        'm': ('ft', 'fathom'),
        'm/s': ('kn', 'km/h'),
        'N': ('kN', 'tf', 'kgf', 'lbf'),
        'rad': ('deg',),
    }.items()
}
"""SI unit → unit mistaken for it → reading per SI value."""

DOORS = ('port_door_depth', 'starboard_door_depth')
TENSIONS = ('port_tension', 'starboard_tension')
PITCHES, ROLLS = ('port_pitch', 'starboard_pitch'), ('port_roll', 'starboard_roll')

TOGETHER = (
    INPUTS[:2], ('speed',), TENSIONS, ('door_spread',), DOORS, ('net_depth',),
    (*DOORS, 'net_depth'), *((name,) for name in (*DOORS, *TENSIONS)),
    ('vertical_opening',), PITCHES, ROLLS, (*PITCHES, *ROLLS),
)  # fmt: skip
"""Channels that are set to a unit together."""

TOWING = (1.2, 3.5)
"""Speeds (m/s) at which mid-water trawls are towed."""


@dataclass(frozen=True)
class Misreading:
    """Misreading: channels whose readings are in ``unit``: ``factor`` times the SI value."""

    channels: tuple[str, ...]
    unit: str
    factor: float

    def repaired(self, means: Mapping[str, float]) -> dict[str, float]:
        """Means converted to SI."""
        return {
            name: mean / self.factor if name in self.channels else mean
            for name, mean in means.items()
        }

    @property
    def optional(self) -> bool:
        """True if windows can do without these channels."""
        return not any(CHANNELS[name].required for name in self.channels)

    def sentence(self, means: Mapping[str, float]) -> str:
        """Sentence on the misreading and its correction."""
        name = next(name for name in self.channels if name in means)
        row = CHANNELS[name]
        return (
            f'{" and ".join(self.channels)} ({row.topic}) look like {self.unit}, expected '
            f'{UNITS[row.unit].name}: {means[name]:.4g} agrees with the other channels as '
            f'{means[name] / self.factor:.4g} {row.unit}'
        )


def misreadings(means: Mapping[str, float]) -> list[Misreading]:
    """Return all possible wrong units of these channels."""
    return [
        Misreading(channels, unit, factor)
        for channels in TOGETHER
        if all(name in means for name in channels)
        for unit, factor in WRONG_UNITS[CHANNELS[channels[0]].unit].items()
    ]


def towable(means: Mapping[str, float]) -> bool:
    """True in the range of a mid-water trawl's operation; a false speed is not worth a solution."""
    return TOWING[0] <= means['speed'] <= TOWING[1]


def plausible_unit(outside: FloatArray, channel: Channel) -> str | None:
    """Name the unit in which values (n,), all outside a channel's range, would be plausible."""
    if np.any((outside >= channel.low) & (outside <= channel.high)):
        return None
    for unit, factor in WRONG_UNITS.get(channel.unit, {}).items():
        if factor > 1.0 and np.all(
            (outside / factor >= channel.low) & (outside / factor <= channel.high)
        ):
            return unit
    return None
