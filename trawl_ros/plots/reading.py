"""Series over time from a bag: truth and readings."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.bags.reader import Bag, RawMessage
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.rotations import about_z, to_angles
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.messages.truth_from_messages import winch_truth
from trawl_ros.plots.records import Series, TowHistory
from trawl_ros.records.samples import INSTRUMENTS, SENSORS, Sample
from trawl_ros.records.topics import absolute
from trawl_ros.records.truth import SIDES

MOST_POINTS = 20_000
"""Of one topic: where there are more, every other one is left out until there are not."""

NOT_DRAWN = ('sonar/bottom', 'vessel/echo_sounder/depth', 'vessel/echo_sounder/school')
"""Topics with numbers that no figure of a tow shows."""

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


@dataclass
class _Rows:
    """Rows of one topic, at most `MOST_POINTS` of them."""

    stride: int = 1
    seen: int = 0
    stamps: list[int] = field(default_factory=list)
    lags: list[int] = field(default_factory=list)
    columns: list[Columns] = field(default_factory=list)

    def due(self) -> bool:
        """Count a message; return True if it is to be taken."""
        self.seen += 1
        return (self.seen - 1) % self.stride == 0

    def add(self, stamp: int, lag: int, columns: Columns) -> None:
        self.stamps.append(stamp)
        self.lags.append(lag)
        self.columns.append(columns)
        if len(self.stamps) > MOST_POINTS:
            self.stride *= 2
            for rows in (self.stamps, self.lags, self.columns):
                del rows[1::2]


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
    bag = Bag(path, namespace=namespace)
    rows = {topic: _Rows() for topic in (*TRUTH, *MEASURED)}
    refused: Counter[str] = Counter()
    reasons: dict[str, str] = {}
    names = {absolute(topic, namespace): topic for topic in rows}
    for raw in bag.raw(names):
        topic = names[raw.topic]
        if rows[topic].due():
            try:
                _take(rows[topic], topic, raw, bag, depth_at)
            except MessageError as reason:
                refused[topic] += 1
                reasons.setdefault(topic, str(reason))
    if not any(table.stamps for table in rows.values()):
        raise BagError(
            f'{path}: holds none of the topics that can be drawn; expected {namespace}/'
            f'winch/joint_states, {namespace}/truth/winch or others of the project'
        )
    problems = [
        *bag.problems,
        *(
            f'{count} messages were left out, the first because {reasons[topic]}'
            for topic, count in refused.items()
        ),
        *(
            f'{topic}: every {table.stride}th of {table.seen} messages is drawn'
            for topic, table in rows.items()
            if table.stride > 1 and topic in MEASURED
        ),
    ]
    stamps = [stamp for table in rows.values() for stamp in table.stamps]
    start, end = min(stamps), max(stamps)
    return TowHistory(
        name=path.stem,
        start=start,
        duration_s=(end - start) / SECOND,
        truth=_completed(_series(rows, tuple(TRUTH), start)),
        measured=_series(rows, MEASURED, start),
        log_lag=round(float(np.median([lag for table in rows.values() for lag in table.lags]))),
        problems=tuple(problems),
    )


def _take(
    rows: _Rows, topic: str, raw: RawMessage, bag: Bag, depth_at: Callable[[float], float]
) -> None:
    message = bag.decode(raw)
    if topic in TRUTH:
        stamp, columns = stamp_of(message), TRUTH[topic](topic, message)
    else:
        sample = to_sample(topic, message)
        stamp, columns = sample.stamp, sample_columns(sample, depth_at)
    rows.add(stamp, raw.log_time - stamp, columns)


def _series(rows: dict[str, _Rows], topics: tuple[str, ...], start: int) -> dict[str, Series]:
    by_name: dict[str, Series] = {}
    for topic in topics:
        table = rows[topic]
        if not table.stamps:
            continue
        order = np.argsort(table.stamps, kind='stable')
        times = (np.array(table.stamps)[order] - start) / SECOND
        for name in table.columns[0]:
            values = np.array([columns[name] for columns in table.columns], dtype=float)[order]
            by_name[name] = Series(times, _continuous(values) if name == 'heading' else values)
    return by_name


def _continuous(angles: FloatArray) -> FloatArray:
    """Angles without jumps of a whole turn, whatever is missing between them."""
    known = np.isfinite(angles)
    unwrapped: FloatArray = angles.copy()
    unwrapped[known] = np.unwrap(angles[known])
    return unwrapped


def _completed(truth: dict[str, Series]) -> dict[str, Series]:
    """Truth that says something, with the distance of the doors; where the sonar's own view of
    the opening is not there, the height at the headrope's centre stands for it.
    """
    known = {name: series for name, series in truth.items() if np.isfinite(series.values).any()}
    if 'port_x' in known and 'starboard_x' in known:
        times = known['port_x'].times
        apart = [
            known[f'port_{axis}'].values
            - np.interp(times, known[f'starboard_{axis}'].times, known[f'starboard_{axis}'].values)
            for axis in 'xyz'
        ]
        known['door_spread'] = Series(times, np.linalg.norm(apart, axis=0))
    if 'centre_height' in known:
        known.setdefault('opening_height', known['centre_height'])
    return known
