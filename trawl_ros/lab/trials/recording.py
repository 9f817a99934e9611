# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Bags of a blind case: samples of a tow with the instruments' errors."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.lab.trials.readings import SENSED_NAMES, SENSOR_KINDS, Sensors, drawn_errors
from trawl_ros.lab.trials.towing import HOLD_S, Course
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.model.water import Water
from trawl_ros.records.channels import CHANNELS, INPUTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)
from trawl_ros.records.topics import absolute

SILENT_S = 90.0
"""Time before and after the planned instant of a state during which a channel is silent."""

CURRENT_STD = 0.2
"""Std (m/s) of the current between GPS and log."""

HEADING_STD = 0.01
GROUND_STD = 0.03
DEPTH_PLACES = {
    'port_door_depth': 'port',
    'starboard_door_depth': 'starboard',
    'net_depth': 'sonar',
}
RANGE_NAMES = {'door_spread': 'spread', 'vertical_opening': 'opening_height'}

Readings = tuple[FloatArray, FloatArray]
"""Times (n,), s, and values (n,) of one channel."""


def record_tows(
    folder: Path,
    courses: Sequence[Course],
    water: Water,
    sensors: Sensors,
    dropouts: float,
    rng: np.random.Generator,
) -> None:
    """Write one bag per tow, ``tow_01`` and so on, each from a stamp of its own.

    Parameters
    ----------
    folder
        To be made.
    courses
        Observables over time, tow by tow.
    water
        Turns depth into pressure.
    sensors
        True errors of the instruments.
    dropouts
        Part of the states in which an optional channel falls silent.
    rng
        Generator of random numbers.
    """
    folder.mkdir()
    for number, course in enumerate(courses, start=1):
        found = _readings(course, sensors, dropouts, rng)
        current = CURRENT_STD * rng.standard_normal(2)
        samples = [*_samples(found, water), *_ship(course, found, current, rng)]
        start = number * 86_400 * SECOND
        with BagWriter(folder / f'tow_{number:02}') as bag:
            for sample in sorted(samples, key=lambda sample: sample.stamp):
                topic, message = sample_message(sample)
                stamp = start + sample.stamp
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
                bag.write(absolute(topic), message.__msgtype__, serialize(message), stamp)


def _readings(
    course: Course, sensors: Sensors, dropouts: float, rng: np.random.Generator
) -> dict[str, Readings]:
    offset, scale = drawn_errors(sensors, rng)
    # When one state is left for the next.
    left = np.add(course.moments, HOLD_S)[:-1]
    found = {}
    for name in SENSED_NAMES:
        kind = SENSOR_KINDS[group_of(name)]
        times = np.arange(0.0, course.times[-1], 1.0 / kind.rate_hz)
        inputs, values = course.at(times)
        if name in INPUTS:
            truth = inputs[:, INPUTS.index(name)]
        else:
            truth = values[:, OBSERVABLES.index(name)]
        noise = sensors.factor(name) * kind.noise(rng, len(times))
        of_state = rng.standard_normal(len(course.moments))
        of_state *= [
            sensors.state_std(name, value) for value in np.interp(course.moments, times, truth)
        ]
        noise += of_state[np.searchsorted(left, times)]
        readings = (1.0 + scale[name]) * truth + offset[name] + noise
        heard = np.ones(len(times), dtype=bool)
        for moment in course.moments:
            # Without a channel that is required there would be no window.
            if rng.uniform() < dropouts and not CHANNELS[name].required:
                heard &= np.abs(times - moment) > SILENT_S
        found[name] = times[heard], readings[heard]
    return found


def _samples(found: dict[str, Readings], water: Water) -> Iterator[Sample]:
    times, port = found['port_length']
    columns = [found[name][1] for name in ('starboard_length', 'port_tension', 'starboard_tension')]
    for time, length, *others in zip(times, port, *columns, strict=True):
        starboard, *tensions = others
        yield WinchSample(_stamp(time), (length, starboard), (0.0, 0.0), (tensions[0], tensions[1]))
    for time, speed in zip(*found['speed'], strict=True):
        yield VelocitySample(_stamp(time), 'water', np.array([speed, 0.0, 0.0]), float('nan'))
    for name, place in DEPTH_PLACES.items():
        std = SENSOR_KINDS[group_of(name)].stated
        for time, depth in zip(*found[name], strict=True):
            pressure = water.pressure(depth)
            yield PressureSample(
                _stamp(time), place, pressure, water.pressure(depth + std) - pressure
            )
    for name, what in RANGE_NAMES.items():
        std = SENSOR_KINDS[group_of(name)].stated
        for time, distance in zip(*found[name], strict=True):
            yield RangeSample(_stamp(time), what, distance, std, 0.5, 500.0)
    for side in ('port', 'starboard'):
        std = SENSOR_KINDS['pitch'].stated
        for time, pitch, roll in _together(found[f'{side}_pitch'], found[f'{side}_roll']):
            yield AttitudeSample(_stamp(time), side, pitch, roll, std)


def _together(first: Readings, second: Readings) -> Iterator[tuple[float, float, float]]:
    """Return the readings of one message; if one is missing, there is no message."""
    common, here, there = np.intersect1d(first[0], second[0], return_indices=True)
    yield from zip(common, first[1][here], second[1][there], strict=True)


def _ship(
    course: Course, found: dict[str, Readings], current: FloatArray, rng: np.random.Generator
) -> Iterator[Sample]:
    ahead = np.array([np.cos(course.heading), np.sin(course.heading)])
    times, _ = found['speed']
    inputs, _ = course.at(times)
    for time, speed in zip(times, inputs[:, 2], strict=True):
        heading = course.heading + HEADING_STD * rng.standard_normal()
        yield HeadingSample(_stamp(time), heading, HEADING_STD)
        ground = speed * ahead + current + GROUND_STD * rng.standard_normal(2)
        yield VelocitySample(_stamp(time), 'ground', np.array([*ground, 0.0]), float('nan'))


def _stamp(time: float) -> int:
    return round(time * SECOND)
