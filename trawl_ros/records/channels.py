# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Channels of the registry, and the readings of them that samples hold."""

import math
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

from trawl_ros.records.registry import Channel as Channel
from trawl_ros.records.registry import Field, with_numbers
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import INSTRUMENTS, SENSORS
from trawl_ros.records.truth import SIDES

INPUTS = ('port_length', 'starboard_length', 'speed')
"""Inputs of the gear; they are measured too, so each has an uncertainty."""


def _bare(channel: Channel) -> str:
    """Return the name of a channel without its side."""
    side, _, name = channel.name.partition('_')
    return name if side in SIDES else channel.name


def _channels() -> dict[str, Channel]:
    """Collect the channels of the registry, both sides of a quantity side by side."""
    found = [field.channel for row in INSTRUMENTS for field in row.fields if field.channel]
    order = list(dict.fromkeys(map(_bare, found)))
    return {row.name: row for row in sorted(found, key=lambda row: order.index(_bare(row)))}


CHANNELS: Mapping[str, Channel] = MappingProxyType(_channels())
"""The channels by name."""

SEABED_TOPIC = 'vessel/echo_sounder/depth'
"""Topic of the water depth; no channel reads it, but windows keep it."""

READ_TOPICS = (*dict.fromkeys(row.topic for row in CHANNELS.values()), SEABED_TOPIC)
"""Topics with readings of any channel or of the seabed."""

REQUIRED = tuple(name for name, channel in CHANNELS.items() if channel.required)
WITNESSES = ('heading', 'yaw_rate', 'ground_east', 'ground_north')
"""Channels that describe the ship's motion and are not part of the fit."""

MEASURED = tuple(name for name in CHANNELS if name not in INPUTS and name not in WITNESSES)
"""Channels compared with the model's observables of the same name."""


class Reading(NamedTuple):
    """Reading (SI) of one channel with its stated std, which is 0 if none is stated.

    ``low`` and ``high`` are the sensor's own limits, if it has any. It is a tuple because a tow has
    hundreds of thousands of them.
    """

    channel: str
    stamp: int
    value: float
    std: float
    low: float = -math.inf
    high: float = math.inf


def readings(sample: Sample, pressure_to_depth: Callable[[float], float]) -> Iterator[Reading]:
    """Split one sample into channel readings; samples without any give none.

    Parameters
    ----------
    sample
        Any instrument's sample.
    pressure_to_depth
        Depth (m, down) under the surface for an absolute pressure (Pa).
    """
    row = SENSORS[sample.topic]
    std = getattr(sample, 'std', 0.0)
    limits = getattr(sample, 'min_range', -math.inf), getattr(sample, 'max_range', math.inf)
    for field in row.fields:
        if field.channel is None:
            continue
        value, name = field.get(sample), field.channel.name
        if not field.is_pressure:
            yield Reading(name, sample.stamp, value, std, *limits)
        elif not math.isfinite(value):
            yield Reading(name, sample.stamp, math.nan, 0.0)
        else:
            depth = pressure_to_depth(value)
            known = std if math.isfinite(std) and std > 0.0 else 0.0
            yield Reading(name, sample.stamp, depth, abs(pressure_to_depth(value + known) - depth))


def channel_values(sample: Sample, pressure_to_depth: Callable[[float], float]) -> dict[str, float]:
    """Return the readings of a sample by channel."""
    return {one.channel: one.value for one in readings(sample, pressure_to_depth)}


def with_channel_values(
    sample: Sample, values: Mapping[str, float], depth_to_pressure: Callable[[float], float]
) -> Sample:
    """Return a sample with its readings replaced, by channel; the reverse of `channel_values`."""
    numbers: dict[Field, float] = {}
    for field in SENSORS[sample.topic].fields:
        if field.channel and field.channel.name in values:
            value = values[field.channel.name]
            numbers[field] = depth_to_pressure(value) if field.is_pressure else value
    return with_numbers(sample, numbers)
