# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Point clouds of one row of 32-bit floats per point, which every viewer reads."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import MessageError

_WIDTH = np.dtype('<f4').itemsize


def point_cloud(header: Any, columns: Mapping[str, FloatArray]) -> Any:
    """Make a ``sensor_msgs/PointCloud2``.

    Parameters
    ----------
    header
        Of the message.
    columns
        Values (n,) by name of the field; display wants ``x``, ``y`` and ``z`` among them.
    """
    table = np.column_stack([np.asarray(column, dtype='<f4') for column in columns.values()])
    fields = [
        ros.sensor_msgs__msg__PointField(
            name, number * _WIDTH, ros.sensor_msgs__msg__PointField.FLOAT32, 1
        )
        for number, name in enumerate(columns)
    ]
    step = _WIDTH * len(fields)
    return ros.sensor_msgs__msg__PointCloud2(
        header=header,
        height=1,
        width=len(table),
        fields=fields,
        is_bigendian=False,
        point_step=step,
        row_step=step * len(table),
        data=np.frombuffer(table.tobytes(), dtype=np.uint8),
        is_dense=True,
    )


def read_point_cloud(topic: str, message: Any, names: Sequence[str]) -> FloatArray:
    """Read fields of 32-bit floats from a point cloud.

    Parameters
    ----------
    topic
        For error messages.
    message
        A ``sensor_msgs/PointCloud2``.
    names
        The fields wanted.

    Returns
    -------
    array
        Shape (n, len(names)).

    Raises
    ------
    MessageError
        If a field is not there as single 32-bit floats, or the data is not as long as it says.
    """
    kind = ros.sensor_msgs__msg__PointField.FLOAT32
    offsets = {
        entry.name: entry.offset
        for entry in message.fields
        if entry.datatype == kind and entry.count == 1
    }
    if missing := [name for name in names if name not in offsets]:
        raise MessageError(
            f'{topic}: no field {", ".join(missing)} of 32-bit floats; there are '
            f'{", ".join(offsets) or "none"}'
        )
    step, count = int(message.point_step), int(message.width) * int(message.height)
    data = np.asarray(message.data, dtype=np.uint8)
    reach = max((offsets[name] for name in names), default=0) + _WIDTH
    if len(data) != step * count or (count and reach > step):
        raise MessageError(
            f'{topic}: {len(data)} bytes for {count} points of {step} bytes; expected '
            f'{step * count} bytes, and {reach} or more per point'
        )
    order = '>f4' if message.is_bigendian else '<f4'
    rows = data.reshape(count, step) if count else np.zeros((0, reach), np.uint8)
    columns = [
        np.ascontiguousarray(rows[:, offsets[name] : offsets[name] + _WIDTH]).view(order)[:, 0]
        for name in names
    ]
    return np.column_stack(columns).astype(float)
