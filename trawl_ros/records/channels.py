"""Channel table: the sample of each channel, its plausible range, noise and bias."""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)


@dataclass(frozen=True)
class Channel:
    """Channel: one measured quantity.

    Attributes
    ----------
    name
        The observable it is compared with, or an input (warp lengths, speed).
    topic
        Source of the readings, for sentences to the user.
    unit
        SI unit of values, ``low``, ``high``, ``noise``, ``bias`` and ``per_state``.
    low, high
        Plausible range; a value outside never enters a mean.
    noise
        Standard deviation of one reading where the sample states none.
    bias, bias_fraction
        Standard deviation of what stays wrong through a tow, however long one averages: an
        absolute part and a part of the mean's size, added in quadrature.
    min_rate
        Lowest rate (Hz) at which the instrument may report.
    delay
        A window takes this channel's readings from as long (s) before its own start and end. A
        steady state does not care, and so a window can be decided at its end though the reading
        that closes it comes late: a period at the lowest rate, the time on its way, and 2 s for
        readings that overtake each other.
    required
        Without it no window is made.
    lively
        A sensor whose readings always scatter, so identical ones mean that it is frozen.
    settles
        A slow response of the gear: a trend in it means that the state is not steady yet.
    per_state
        Standard deviation of what is wrong by another amount in each steady state, where it was
        measured (`config/instruments/default.yaml`); else 0, and a share of the bias is taken.
    leap
        Distance that the quantity cannot move by in a window. A reading of an acoustic range
        that is further from the median is that of a false echo, which says nothing of the
        sensor's noise: it is left out before outliers of the noise are looked for. Infinite
        where false echoes do not occur.
    """

    name: str
    topic: str
    unit: str
    low: float
    high: float
    noise: float
    bias: float
    bias_fraction: float
    min_rate: float
    delay: float
    required: bool
    lively: bool = False
    settles: bool = False
    per_state: float = 0.0
    leap: float = math.inf

    @property
    def longest_gap(self) -> float:
        """Longest ordinary silence (s): four periods, at least 10 s."""
        return max(10.0, 4.0 / self.min_rate)

    def bias_std(self, mean: float) -> float:
        """Standard deviation of the calibration at this mean."""
        return math.hypot(self.bias, self.bias_fraction * mean)

    def steady_std(self, mean: float) -> float:
        """Standard deviation of all that stays wrong through one steady state at this mean."""
        return math.hypot(self.bias_std(mean), self.per_state)

    def state_std(self, bias: float, share: float) -> float:
        """Standard deviation of what changes from one steady state to the next.

        It is ``share`` of the bias where none was measured. A share of 0 is a tow in which nothing
        changes with the state.
        """
        return (self.per_state or share * bias) if share else 0.0


def _pair(both: Channel) -> list[Channel]:
    """Channels of both sides that are the same but for name and topic."""
    return [
        replace(both, name=f'{side}_{both.name}', topic=both.topic.format(side=side))
        for side in ('port', 'starboard')
    ]


_DEGREE = math.pi / 180.0

INPUTS = ('port_length', 'starboard_length', 'speed')
"""Inputs of the gear; measured too, so each has an uncertainty of its own."""

_TABLE = (
    *_pair(
        Channel(
            'length', 'winch/joint_states', 'm', 1.0, 6000.0, 0.1, 0.5, 0.002, 1.0, 4.0,
            required=True, per_state=0.6,
        )
    ),
    Channel(
        'speed', 'vessel/velocity_water', 'm/s', -2.0, 12.0, 0.05, 0.01, 0.005, 1.0, 4.0,
        required=True, lively=True,
    ),
    *_pair(
        Channel(
            'tension', 'winch/joint_states', 'N', -5e3, 2e6, 500.0, 200.0, 0.01, 1.0, 4.0,
            required=True, lively=True, settles=True,
        )
    ),
    *_pair(
        Channel(
            'door_depth', 'door/{side}/pressure', 'm', -5.0, 3000.0, 0.3, 0.5, 0.005, 0.2, 10.0,
            required=True, lively=True, settles=True,
        )
    ),
    Channel(
        'door_spread', 'door/spread', 'm', 1.0, 1000.0, 1.0, 0.5, 0.005, 0.2, 10.0,
        required=True, lively=True, settles=True, per_state=0.6,
        leap=20.0,
    ),
    Channel(
        'net_depth', 'sonar/pressure', 'm', -5.0, 3000.0, 0.3, 0.5, 0.005, 0.5, 6.0,
        required=True, lively=True, settles=True,
    ),
    *_pair(
        Channel(
            'pitch', 'door/{side}/attitude', 'rad', -1.6, 1.6, 1.0 * _DEGREE, 0.5 * _DEGREE, 0.0,
            0.2, 10.0, required=False, lively=True,
        )
    ),
    *_pair(
        Channel(
            'roll', 'door/{side}/attitude', 'rad', -1.6, 1.6, 1.0 * _DEGREE, 0.5 * _DEGREE, 0.0,
            0.2, 10.0, required=False, lively=True,
        )
    ),
    # Stamped when a sweep of 16 s begins, sent when it ends, and 16 s pass until the next.
    Channel(
        'vertical_opening', 'sonar/opening_height', 'm', 0.5, 300.0, 2.0, 1.0, 0.03, 0.02, 36.0,
        required=False,
    ),
    # Heading and rate of turn only tell turning from straight towing.
    Channel(
        'heading', 'vessel/heading', 'rad', -10.0, 10.0, 0.02, 0.0, 0.0, 1.0, 4.0,
        required=False,
    ),
    Channel(
        'yaw_rate', 'vessel/velocity_water', 'rad/s', -1.0, 1.0, 0.002, 0.0, 0.0, 1.0, 4.0,
        required=False,
    ),
    # Velocity over ground only tells whether the log sees the water.
    *(
        Channel(
            f'ground_{axis}', 'vessel/velocity_ground', 'm/s', -12.0, 12.0, 0.05, 0.0, 0.0, 1.0,
            4.0, required=False,
        )
        for axis in ('east', 'north')
    ),
)  # fmt: skip

CHANNELS: Mapping[str, Channel] = MappingProxyType({row.name: row for row in _TABLE})
"""The channel table by name."""

SEABED_TOPIC = 'vessel/echo_sounder/depth'
"""Topic of the water's depth, which no channel has and windows take along."""

READ_TOPICS = (*dict.fromkeys(row.topic for row in _TABLE), SEABED_TOPIC)
"""Topics with readings of any channel, and of the seabed."""

REQUIRED = tuple(name for name, channel in CHANNELS.items() if channel.required)
WITNESSES = ('heading', 'yaw_rate', 'ground_east', 'ground_north')
"""Channels that tell how the ship moves; no part of the fit."""

MEASURED = tuple(name for name in CHANNELS if name not in INPUTS and name not in WITNESSES)
"""Channels compared with the model's observables of the same name."""


class Reading(NamedTuple):
    """Reading: one value (SI) of one channel with its stated std, 0 where none is stated.

    ``low`` and ``high`` are the sensor's own limits where it has any. A tuple, for a tow has
    hundreds of thousands.
    """

    channel: str
    stamp: int
    value: float
    std: float
    low: float = -math.inf
    high: float = math.inf


_DISTANCES = {'spread': 'door_spread', 'opening_height': 'vertical_opening'}
"""Of the distances these belong to observables. The sonar's width is that in its own plane, far
behind the wing tips between which the model's horizontal opening is measured."""


def readings(sample: Sample, pressure_to_depth: Callable[[float], float]) -> Iterator[Reading]:
    """Split one sample into channel readings; samples without any give none.

    Parameters
    ----------
    sample
        Any instrument's sample.
    pressure_to_depth
        Depth (m, down) under the surface for an absolute pressure (Pa).
    """
    stamp = sample.stamp
    match sample:
        case WinchSample():
            for side, length, tension in zip(
                ('port', 'starboard'), sample.lengths, sample.tensions, strict=True
            ):
                yield Reading(f'{side}_length', stamp, length, 0.0)
                yield Reading(f'{side}_tension', stamp, tension, 0.0)
        case PressureSample():
            name = 'net_depth' if sample.place == 'sonar' else f'{sample.place}_door_depth'
            if not math.isfinite(sample.pressure):
                yield Reading(name, stamp, math.nan, 0.0)
                return
            depth = pressure_to_depth(sample.pressure)
            std = sample.std if math.isfinite(sample.std) and sample.std > 0.0 else 0.0
            yield Reading(name, stamp, depth, abs(pressure_to_depth(sample.pressure + std) - depth))
        case AttitudeSample():
            yield Reading(f'{sample.side}_pitch', stamp, sample.pitch, sample.std)
            yield Reading(f'{sample.side}_roll', stamp, sample.roll, sample.std)
        case RangeSample():
            if sample.what in _DISTANCES:
                name, limits = _DISTANCES[sample.what], (sample.min_range, sample.max_range)
                yield Reading(name, stamp, sample.distance, sample.std, *limits)
        case VelocitySample(over='water'):
            yield Reading('speed', stamp, float(sample.velocity[0]), 0.0)
            yield Reading('yaw_rate', stamp, sample.yaw_rate, 0.0)
        case VelocitySample(over='ground'):
            yield Reading('ground_east', stamp, float(sample.velocity[0]), 0.0)
            yield Reading('ground_north', stamp, float(sample.velocity[1]), 0.0)
        case HeadingSample():
            yield Reading('heading', stamp, sample.heading, sample.std)
        case _:
            return
