# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Series over time from a bag: truth and readings."""

from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.rotations import about_z, to_angles
from trawl_ros.core.time import SECOND
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.truth_from_messages import winch_truth
from trawl_ros.plots.bag_messages import BagMessages, TowMessage
from trawl_ros.plots.records import Kind, Quantities, Series, TowHistory
from trawl_ros.records.samples import Sample
from trawl_ros.records.sensors import INSTRUMENTS, SENSORS
from trawl_ros.records.truth import SIDES

NOT_DRAWN = ('sonar/bottom', 'vessel/echo_sounder/depth', 'vessel/echo_sounder/school')
"""Topics with numbers that no figure shows."""

Columns = dict[str, float]


def _winch_columns(lengths: Any, tensions: Any) -> Columns:
    return {
        **{f'{side}_length': value for side, value in zip(SIDES, lengths, strict=True)},
        **{f'{side}_tension': value for side, value in zip(SIDES, tensions, strict=True)},
    }


def _true_winch(topic: str, message: Any) -> Columns:
    port, starboard = winch_truth(topic, message)
    return _winch_columns((port.length, starboard.length), (port.tension, starboard.tension))


def _true_door(topic: str, message: Any) -> Columns:
    side = topic.split('/')[2]
    place, roll, pitch, _ = _pose(topic, message.pose.pose)
    coordinates = {f'{side}_{axis}': value for axis, value in zip('xyz', place, strict=True)}
    return {
        **coordinates,
        f'{side}_door_depth': -place[2],
        f'{side}_pitch': pitch,
        f'{side}_roll': roll,
    }


def _true_vessel(topic: str, message: Any) -> Columns:
    (east, north, _), _, _, heading = _pose(topic, message.pose.pose)
    forward, port = message.twist.twist.linear.x, message.twist.twist.linear.y
    over_east, over_north, _ = about_z(heading) @ np.array([forward, port, 0.0])
    return {'east': east, 'north': north, 'heading': heading, **_ground(over_east, over_north)}


def _true_opening(topic: str, message: Any) -> Columns:
    opening = message.vector
    return {'wing_width': opening.x, 'centre_height': opening.y, 'net_depth': opening.z}


def _true_sonar_opening(topic: str, message: Any) -> Columns:
    return {'opening_height': message.vector.x, 'opening_width': message.vector.y}


def _true_water(topic: str, message: Any) -> Columns:
    return {'speed_water': message.twist.linear.x, 'drift_water': message.twist.linear.y}


def _pose(topic: str, pose: Any) -> tuple[tuple[float, float, float], float, float, float]:
    turn, place = pose.orientation, pose.position
    try:
        angles = to_angles((turn.x, turn.y, turn.z, turn.w))
    except ValueError as error:
        raise MessageError(f'{topic}: {error}') from error
    return (place.x, place.y, place.z), *angles


def _ground(east: float, north: float) -> Columns:
    return {
        'ground_east': east,
        'ground_north': north,
        'speed_ground': float(np.hypot(east, north)),
    }


TRUTH: dict[str, Callable[[str, Any], Columns]] = {
    'truth/winch': _true_winch,
    'truth/door/port/odom': _true_door,
    'truth/door/starboard/odom': _true_door,
    'truth/net/opening': _true_opening,
    'truth/sonar/opening': _true_sonar_opening,
    'truth/vessel/odom': _true_vessel,
    'truth/vessel/velocity_water': _true_water,
}
MEASURED = tuple(row.name for row in INSTRUMENTS if row.fields and row.name not in NOT_DRAWN)


def sample_columns(sample: Sample, depth_at: Callable[[float], float]) -> Columns:
    """Split a sample into the quantities of `TowHistory.measured`; depths come from pressures."""
    columns: Columns = {}
    for number in SENSORS[sample.topic].fields:
        value = number.get(sample)
        if number.is_pressure and np.isfinite(value):
            value = depth_at(value)
        if number.curve:
            columns[number.curve] = value
    if 'ground_east' in columns:
        return _ground(columns['ground_east'], columns['ground_north'])
    return columns


class QuantityReader:
    """Reader of quantities from messages of truth and instruments, for pictures and the view.

    Parameters
    ----------
    depth_at
        Depth (m) at an absolute pressure (Pa).
    """

    def __init__(self, depth_at: Callable[[float], float]) -> None:
        self._depth_at = depth_at
        self._doors: dict[str, tuple[int, FloatArray]] = {}

    def sample(self, sample: Sample) -> Quantities:
        """Return the quantities of a sample; it may have none."""
        return Quantities(sample.stamp, 'measured', sample_columns(sample, self._depth_at))

    def truth(self, topic: str, message: Any) -> Quantities:
        """Return the quantities of a message of one of `TRUTH`.

        The distance of the doors comes with the second of two messages of the same stamp.

        Raises
        ------
        MessageError
            If it contradicts its topic.
        """
        stamp, columns = stamp_of(message), TRUTH[topic](topic, message)
        if topic.startswith('truth/door/'):
            side = topic.split('/')[2]
            place = np.array([columns[f'{side}_{axis}'] for axis in 'xyz'])
            self._doors[side] = stamp, place
            places = [place for at, place in self._doors.values() if at == stamp]
            if len(places) == len(SIDES):
                columns['door_spread'] = float(np.linalg.norm(places[0] - places[1]))
        return Quantities(stamp, 'truth', columns)


def read_history(path: Path, depth_at: Callable[[float], float], namespace: str) -> TowHistory:
    """Read the series for the figures of a bag.

    Parameters
    ----------
    path
        The bag.
    depth_at
        Depth (m) at an absolute pressure (Pa).
    namespace
        Of the project's topics in it.

    Raises
    ------
    BagError
        If there is no such bag, or nothing in it that could be drawn.
    """
    bags = BagMessages([path], namespace, topics=(*TRUTH, *MEASURED), fewer={})
    reader = QuantityReader(depth_at)
    rows: dict[Kind, dict[str, list[tuple[int, float]]]] = {'truth': {}, 'measured': {}}
    stamps, lags = array('q'), array('q')

    def take(given: TowMessage) -> None:
        if given.topic in TRUTH:
            read = reader.truth(given.topic, given.message)
        else:
            read = reader.sample(to_sample(given.topic, given.message))
        stamps.append(read.stamp)
        lags.append(given.log_time - read.stamp)
        for name, value in read.values.items():
            rows[read.kind].setdefault(name, []).append((read.stamp, value))

    bags.read(take)
    if not stamps:
        raise BagError(f'{path}: no message that can be drawn ({"; ".join(bags.problems)})')
    start, end = min(stamps), max(stamps)
    return TowHistory(
        name=path.stem,
        start=start,
        duration_s=(end - start) / SECOND,
        truth=_completed(_series(rows['truth'], start)),
        measured=_series(rows['measured'], start),
        log_lag=round(float(np.median(lags))),
        # Truth comes so often that nobody misses some of it.
        problems=tuple(text for text in bags.problems if not text.startswith('truth/')),
    )


def _series(rows: dict[str, list[tuple[int, float]]], start: int) -> dict[str, Series]:
    by_name: dict[str, Series] = {}
    for name, pairs in rows.items():
        stamps = np.array([stamp for stamp, _ in pairs], dtype=np.int64)
        order = np.argsort(stamps, kind='stable')
        values = np.array([value for _, value in pairs], dtype=float)[order]
        times = (stamps[order] - start) / SECOND
        by_name[name] = Series(times, _continuous(values) if name == 'heading' else values)
    return by_name


def _continuous(angles: FloatArray) -> FloatArray:
    """Angles without jumps of a whole turn, also over gaps."""
    known = np.isfinite(angles)
    unwrapped: FloatArray = angles.copy()
    unwrapped[known] = np.unwrap(angles[known])
    return unwrapped


def _completed(truth: dict[str, Series]) -> dict[str, Series]:
    """Truth without series that hold no values.

    If the sonar's own opening height is missing, the height at the headrope's centre replaces it.
    """
    known = {name: series for name, series in truth.items() if np.isfinite(series.values).any()}
    if 'centre_height' in known:
        known.setdefault('opening_height', known['centre_height'])
    return known
