# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages as rows: one column per number or text, named by the path of its field, with its unit.

A time gives two columns, ``_s`` for reading and plotting and ``_ns`` for the exact value. Elements
of an array are counted from 0 in brackets: ``position[1]``.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys.store import Typestore

from trawl_ros.core.time import SECOND

MAX_COLUMNS = 1000
"""Largest number of columns of one field."""

_TIMES = ('builtin_interfaces/msg/Time', 'builtin_interfaces/msg/Duration')

_JOINTS = {'position': 'm', 'velocity': 'm/s', 'effort': 'N'}
_TWIST = {'linear': 'm/s', 'angular': 'rad/s'}

_BY_TOPIC: Mapping[str, Mapping[str, str]] = {
    'truth/winch': _JOINTS,
    'winch/joint_states': _JOINTS,
    'command/winch': _JOINTS,
    'truth/door/port/angles': {'vector': 'rad'},
    'truth/door/starboard/angles': {'vector': 'rad'},
    'truth/net/opening': {'vector': 'm'},
}
"""Units by topic and path that the topic table defines and the message type does not."""

_BY_TYPE: Mapping[str, Mapping[str, str]] = {
    'geometry_msgs/msg/PointStamped': {'point': 'm'},
    'geometry_msgs/msg/PolygonStamped': {'polygon.points': 'm'},
    'geometry_msgs/msg/PoseArray': {'poses.position': 'm'},
    'geometry_msgs/msg/PoseStamped': {'pose.position': 'm'},
    'geometry_msgs/msg/TwistStamped': {f'twist.{part}': unit for part, unit in _TWIST.items()},
    'geometry_msgs/msg/WrenchStamped': {'wrench.force': 'N', 'wrench.torque': 'N m'},
    'nav_msgs/msg/Odometry': {
        'pose.pose.position': 'm',
        **{f'twist.twist.{part}': unit for part, unit in _TWIST.items()},
    },
    'sensor_msgs/msg/FluidPressure': {'fluid_pressure': 'Pa', 'variance': 'Pa^2'},
    'sensor_msgs/msg/Imu': {
        'orientation_covariance': 'rad^2',
        'angular_velocity': 'rad/s',
        'angular_velocity_covariance': 'rad^2/s^2',
        'linear_acceleration': 'm/s^2',
        'linear_acceleration_covariance': 'm^2/s^4',
    },
    'sensor_msgs/msg/LaserScan': {
        'angle_min': 'rad',
        'angle_max': 'rad',
        'angle_increment': 'rad',
        'time_increment': 's',
        'scan_time': 's',
        'range_min': 'm',
        'range_max': 'm',
        'ranges': 'm',
    },
    'sensor_msgs/msg/NavSatFix': {
        'latitude': 'deg',
        'longitude': 'deg',
        'altitude': 'm',
        'position_covariance': 'm^2',
    },
    'sensor_msgs/msg/Range': {
        'field_of_view': 'rad',
        'min_range': 'm',
        'max_range': 'm',
        'range': 'm',
        'variance': 'm^2',
    },
}

Place = tuple[int, ...]
"""Position of a column in its message: field and element numbers from the top down."""


@dataclass(frozen=True, order=True)
class FlatColumn:
    """Column: its steps, its name, and its field's path without element numbers.

    ``steps`` are the names and numbers by which a message's value is reached.
    """

    place: Place
    name: str
    path: str
    steps: tuple[str | int, ...]

    def value(self, message: Any) -> Any:
        """Return the value in a message; None if its array is shorter."""
        value = message
        try:
            for step in self.steps:
                value = value[step] if isinstance(step, int) else getattr(value, step)
        except IndexError:
            return None
        if getattr(value, '__msgtype__', '') not in _TIMES:
            return value
        stamp = int(value.sec) * SECOND + int(value.nanosec)
        return as_seconds(stamp) if self.name.endswith('_s') else stamp


@dataclass
class FlatLayout:
    """Layout of a topic's table: its columns, and the arrays that do not go into columns.

    Attributes
    ----------
    limit
        Elements up to which an array is spread over columns.
    left_out
        Reason by the path of each array that is left out.
    """

    limit: int
    columns: set[FlatColumn] = field(default_factory=set)
    left_out: dict[str, str] = field(default_factory=dict)

    def learn(self, message: Any) -> None:
        """Add the columns of a message; an array that is once too long stays excluded."""
        self.columns.update(self._walk(message, (), '', '', ()))
        if self.left_out:
            self.columns = {column for column in self.columns if not self._is_out(column.path)}

    def finish(self) -> list[FlatColumn]:
        """Return the columns in the order of the fields, without fields that need too many."""
        for path, count in self._top_level().items():
            if count > MAX_COLUMNS:
                self.left_out[path] = f'would need {count} columns'
        self.columns = {column for column in self.columns if not self._is_out(column.path)}
        return sorted(self.columns)

    def _is_out(self, path: str) -> bool:
        return any(path == out or path.startswith((f'{out}.', f'{out}_')) for out in self.left_out)

    def _top_level(self) -> dict[str, int]:
        counts: dict[str, int] = {}
        for column in self.columns:
            top = column.path.partition('.')[0]
            counts[top] = counts.get(top, 0) + 1
        return counts

    def _walk(
        self, value: Any, place: Place, name: str, path: str, steps: tuple[str | int, ...]
    ) -> Iterator[FlatColumn]:
        if path in self.left_out:
            return
        if getattr(value, '__msgtype__', '') in _TIMES:
            yield FlatColumn((*place, 0), f'{name}_s', f'{path}_s', steps)
            yield FlatColumn((*place, 1), f'{name}_ns', f'{path}_ns', steps)
        elif is_dataclass(value):
            for number, field in enumerate(fields(value)):
                # Constants stand among the fields; of those, ROS wants small letters.
                if field.name.startswith('_') or field.name.isupper():
                    continue
                inner = f'{name}.{field.name}' if name else field.name
                below = f'{path}.{field.name}' if path else field.name
                deeper = (*steps, field.name)
                yield from self._walk(
                    getattr(value, field.name), (*place, number), inner, below, deeper
                )
        elif isinstance(value, list | np.ndarray):
            if reason := self._refusal(value):
                self.left_out[path] = reason
                return
            for number, element in enumerate(value):
                deeper = (*steps, number)
                yield from self._walk(element, (*place, number), f'{name}[{number}]', path, deeper)
        else:
            yield FlatColumn(place, name, path, steps)

    def _refusal(self, value: Any) -> str:
        blob = isinstance(value, np.ndarray) and value.dtype.itemsize == 1 and value.dtype != bool
        if blob and len(value):
            return 'is an image or another blob of bytes'
        if len(value) > self.limit:
            return f'has {len(value)} elements, more than {self.limit}'
        return ''


def as_seconds(stamp: int) -> str:
    """Write nanoseconds as seconds with all digits, which a float would lose."""
    sign = '-' if stamp < 0 else ''
    seconds, nanoseconds = divmod(abs(stamp), SECOND)
    return f'{sign}{seconds}.{nanoseconds:09d}'


def as_text(value: Any, *, single: bool = False) -> str:
    """Write a value for a cell: numbers in the shortest exact form, NaN and None as an empty text.

    ``single`` states that the number has 32 bits, and so needs fewer digits.
    """
    if value is None:
        return ''
    if isinstance(value, float | np.floating):
        if math.isnan(value):
            return ''
        return str(np.float32(value)) if single else repr(float(value))
    return str(int(value)) if isinstance(value, bool | np.bool_) else str(value)


def singles(store: Typestore, type_name: str) -> frozenset[str]:
    """Return the paths of a type's fields that are 32-bit floats."""
    return frozenset(path for path, base in _leaves(store, type_name, '') if base == 'float32')


def varies(store: Typestore, type_name: str) -> bool:
    """True if messages of a type can differ in their columns, since it contains sequences."""
    return any(base == 'sequence' for _, base in _leaves(store, type_name, ''))


def _leaves(store: Typestore, type_name: str, path: str) -> Iterator[tuple[str, str]]:
    definitions: Mapping[str, Any] = store.fielddefs
    for name, (node, detail) in definitions[type_name][1]:
        inner = f'{path}.{name}' if path else name
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            if node is Nodetype.SEQUENCE:
                yield inner, 'sequence'
            node, detail = detail[0]
        if node is Nodetype.NAME:
            yield from _leaves(store, detail, inner)
        else:
            yield inner, detail[0]


def field_unit(topic: str, type_name: str, path: str) -> str:
    """Return the unit of a field, '' where it has none or none is known.

    Parameters
    ----------
    topic
        Relative name, as in the contract.
    type_name
        E.g. ``sensor_msgs/msg/Range``.
    path
        Names down to the field, without element numbers: ``pose.pose.position.x``.
    """
    if path.endswith('_ns'):
        return 'ns'
    if path.endswith('_s'):
        return 's'
    known = {**_BY_TYPE.get(type_name, {}), **_BY_TOPIC.get(topic, {})}
    steps = path.split('.')
    for length in range(len(steps), 0, -1):
        if unit := known.get('.'.join(steps[:length])):
            return unit
    return ''
