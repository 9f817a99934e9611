# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Rows of the registry: a topic, its sensor, and the numbers that the sensor reports.

`trawl_ros.records.topics` and `trawl_ros.records.sensors` hold the rows.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from trawl_ros.records.truth import SIDES

NAMESPACE = 'trawl'

MAP = 'map'
VESSEL = 'vessel'
SONAR = 'sonar'
ODOM = 'odom'
ECHO_SOUNDER = 'echo_sounder'
SONAR_WIDTH = 'sonar_width'
DOOR_FRAMES = {side: f'door_{side}' for side in SIDES}
DOOR_SPREAD = 'door_port_spread'
SLANT_RANGE = 'slant_range'

WINCH_NAMES = tuple(f'{side}_warp' for side in SIDES)
"""Joint names of the winches, in the order of `SIDES`."""


class StampedSample(Protocol):
    """Sample of an instrument: a frozen dataclass with a topic and a stamp."""

    @property
    def stamp(self) -> int:
        """Time of sampling, ns."""

    @property
    def topic(self) -> str:
        """Relative name of the topic that carries it."""


SampleT = TypeVar('SampleT', bound=StampedSample)
SampleT_co = TypeVar('SampleT_co', bound=StampedSample, covariant=True)


@dataclass(frozen=True)
class Topic:
    """Topic: a row of the registry.

    Attributes
    ----------
    name
        Relative to the namespace unless it begins with a slash.
    type
        Of its messages.
    frame
        ``header.frame_id``; '' where the type has no header.
    rate
        Usual rate, Hz; None on an event.
    sentence
        Content.
    published_by, heard_by
        Names of the nodes that may, apart from those that play, record or show everything.
    latched
        True if a late subscriber gets the last message.
    silence
        Longest time (s) without a message of an instrument that works at sea.
    """

    name: str
    type: str
    frame: str
    rate: float | None
    sentence: str
    published_by: tuple[str, ...] = ()
    heard_by: tuple[str, ...] = ()
    latched: bool = False
    silence: float = 0.0


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
        A window takes this channel's readings from this long (s) before its own start and end. So
        a window can be decided at its end although the last reading comes late, and a steady state
        is the same at both times. It is a period at the lowest rate, the time on the way, and 2 s
        for readings that overtake each other.
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
    usual
        False for a sensor that few ships have: plans of trials do not count on it, and windows do
        not wait for its first reading.
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
    usual: bool = True

    @property
    def longest_gap(self) -> float:
        """Longest ordinary silence (s): four periods, at least 10 s."""
        return max(10.0, 4.0 / self.min_rate)

    def bias_std(self, mean: float) -> float:
        """Standard deviation of the calibration error at this mean."""
        return math.hypot(self.bias, self.bias_fraction * mean)

    def steady_std(self, mean: float) -> float:
        """Standard deviation of the errors that are constant in one steady state, at this mean."""
        return math.hypot(self.bias_std(mean), self.per_state)

    def state_std(self, bias: float, share: float) -> float:
        """Standard deviation of the errors that change from one steady state to the next.

        It is ``share`` of the bias if it was not measured. With a share of 0 the errors of a tow do
        not change with the state.
        """
        return (self.per_state or share * bias) if share else 0.0


@dataclass(frozen=True)
class Field:
    """Number of a sample.

    Attributes
    ----------
    name
        In logs, sentences and errors.
    attribute, index
        Attribute of the sample, and the place in it where it is a sequence.
    quantity
        Quantity in logs and sentences ('length', 'angle' …); '' for a number they do not give.
    at
        Attribute of the message, or the angle (roll, pitch, yaw) of its orientation.
    low, high, unit
        Bounds of what any instrument of a ship can report, and their unit. ``scale`` is the size
        of that unit in the sample's.
    channel
        Channel that it is a reading of. The channel of a pressure is a depth.
    series
        Name in figures; by default that of the channel.
    on_course
        True if successive readings lie on one course, so that a second source stands out.
    """

    name: str
    attribute: str
    index: int | None = None
    quantity: str = ''
    at: str = ''
    low: float = -math.inf
    high: float = math.inf
    unit: str = ''
    scale: float = 1.0
    channel: Channel | None = None
    series: str = ''
    on_course: bool = False

    def get(self, sample: StampedSample) -> float:
        """Return the number, in the sample's unit."""
        value = getattr(sample, self.attribute)
        return float(value if self.index is None else value[self.index])

    @property
    def is_pressure(self) -> bool:
        """True if its channel is the depth that belongs to this pressure."""
        return self.quantity == 'pressure'

    @property
    def curve(self) -> str:
        """Name of its series in figures; '' without one."""
        return self.series or (self.channel.name if self.channel else '')


@dataclass(frozen=True)
class Sensor(Topic, Generic[SampleT_co]):
    """Sensor: the row of a topic whose messages are samples.

    Attributes
    ----------
    blank
        Sample without readings.
    fields
        Its numbers; none for images and clouds.
    partial
        True if a log's sample may lack some of its numbers.
    beam_width
        Beam width of a range sensor, for display, rad.
    errors
        Key of its errors in a file of instruments, next to those of the node, for a sensor that
        does nothing but measure the observables of its channels; '' for one with code of its own.
    """

    blank: SampleT_co = field(kw_only=True)
    fields: tuple[Field, ...] = ()
    partial: bool = False
    beam_width: float = 0.0
    errors: str = ''

    @property
    def states_noise(self) -> bool:
        """True if its messages state their noise."""
        return hasattr(self.blank, 'std')

    @property
    def is_range(self) -> bool:
        """True if it measures a distance between two limits."""
        return hasattr(self.blank, 'max_range')


def changed(sample: SampleT, **attributes: object) -> SampleT:
    """Return a sample with some attributes replaced."""
    # A dataclass, which a protocol cannot say.
    return replace(sample, **attributes)  # type: ignore[type-var]  # as said above


def with_numbers(sample: SampleT, numbers: Mapping[Field, float]) -> SampleT:
    """Return a sample with its numbers replaced, in the sample's units."""
    if not numbers:
        return sample
    single = {one.attribute: value for one, value in numbers.items() if one.index is None}
    several: dict[str, list[float]] = {}
    for number, value in numbers.items():
        if number.index is not None:
            name = number.attribute
            several.setdefault(name, list(getattr(sample, name)))[number.index] = value
    arrays = {
        name: np.array(values) if isinstance(getattr(sample, name), np.ndarray) else tuple(values)
        for name, values in several.items()
    }
    return changed(sample, **single, **arrays)
