# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages of the identification: coefficients, their covariance, and innovations.

``names`` are those of the parameters of the boards' law, by default of eq. 14.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import MessageError
from trawl_ros.messages.diagnostics import OK, WARN, Status, diagnostic_array
from trawl_ros.messages.pieces import TopicMessage, joint_column
from trawl_ros.messages.stamps import header
from trawl_ros.records.channels import CHANNELS
from trawl_ros.records.coefficients import COEFFICIENTS

ESTIMATE = 'identification/estimate'
COVARIANCE = 'identification/covariance'
INNOVATION = 'identification/innovation'
COEFFICIENTS_BY_NAME = 'identification/coefficients'
INNOVATIONS_BY_NAME = 'identification/innovations'


@dataclass(frozen=True)
class ChannelInnovation:
    """Innovation of a channel: measured minus predicted, its standard deviation, and test ratio.

    ``innovation`` and ``std`` are in the channel's unit; a ratio below 0.5 is normal, above
    1 the measurement is rejected.
    """

    channel: str
    innovation: float
    std: float
    ratio: float


def estimate_message(
    values: Sequence[float] | FloatArray, names: Sequence[str] = COEFFICIENTS
) -> TopicMessage:
    """Turn the coefficients (q,) into a message."""
    return ESTIMATE, _array(np.asarray(values, dtype=float), names, 1)


def covariance_message(matrix: FloatArray, names: Sequence[str] = COEFFICIENTS) -> TopicMessage:
    """Turn their covariance (q, q) into a message, row-major."""
    return COVARIANCE, _array(np.asarray(matrix, dtype=float), names, 2)


def innovation_message(stamp: int, innovations: Sequence[ChannelInnovation]) -> TopicMessage:
    """Turn the innovations of one window into a message stamped with it (ns)."""
    columns = (
        [float(getattr(item, field)) for item in innovations]
        for field in ('innovation', 'std', 'ratio')
    )
    return INNOVATION, ros.sensor_msgs__msg__JointState(
        header(stamp, ''),
        [item.channel for item in innovations],
        *(np.array(column, dtype=float) for column in columns),
    )


def coefficients_message(
    stamp: int,
    values: FloatArray,
    std: FloatArray,
    determined: Sequence[bool],
    names: Sequence[str] = COEFFICIENTS,
) -> TopicMessage:
    """Turn the coefficients into one stamped message (ns): a status for each, with its name."""
    rows = zip(names, values, std, determined, strict=True)
    return COEFFICIENTS_BY_NAME, diagnostic_array(
        stamp,
        [
            Status(
                name,
                OK if known else WARN,
                'determined' if known else 'not determined',
                {'value': repr(float(value)), 'std': repr(float(deviation))},
            )
            for name, value, deviation, known in rows
        ],
    )


def innovations_message(stamp: int, innovations: Sequence[ChannelInnovation]) -> TopicMessage:
    """Turn the innovations of one window into a message (ns): a status for each channel."""
    return INNOVATIONS_BY_NAME, diagnostic_array(
        stamp,
        [
            Status(
                item.channel,
                OK if item.ratio <= 1.0 else WARN,
                'within its stated errors' if item.ratio <= 1.0 else 'beyond its stated errors',
                {
                    'innovation': repr(item.innovation),
                    'std': repr(item.std),
                    'test ratio': repr(item.ratio),
                    'unit': CHANNELS[item.channel].unit,
                },
            )
            for item in innovations
        ],
    )


def read_estimate(message: Any, names: Sequence[str] = COEFFICIENTS) -> FloatArray:
    """Read the coefficients (q,).

    Raises
    ------
    MessageError
        If size or label are not those of the contract.
    """
    return _values(ESTIMATE, message, names, 1)


def read_covariance(message: Any, names: Sequence[str] = COEFFICIENTS) -> FloatArray:
    """Read the covariance (q, q).

    Raises
    ------
    MessageError
        If size or label are not those of the contract.
    """
    return _values(COVARIANCE, message, names, 2)


def read_innovations(message: Any) -> tuple[ChannelInnovation, ...]:
    """Read the innovations of one window.

    Raises
    ------
    MessageError
        If channels repeat or the fields differ in length.
    """
    columns = [joint_column(INNOVATION, message, f) for f in ('position', 'velocity', 'effort')]
    return tuple(
        ChannelInnovation(name, *(column[name] for column in columns)) for name in message.name
    )


def _array(
    values: FloatArray, names: Sequence[str], dimensions: int
) -> ros.std_msgs__msg__Float64MultiArray:
    shape, label = (len(names),) * dimensions, ','.join(names)
    if values.shape != shape:
        raise ValueError(f'coefficients of shape {values.shape}, expected {shape}')
    layout = [
        # A stride is the number of values from one entry of the dimension outside to its next.
        ros.std_msgs__msg__MultiArrayDimension(label, size, int(np.prod(shape[axis:])))
        for axis, size in enumerate(shape)
    ]
    return ros.std_msgs__msg__Float64MultiArray(
        ros.std_msgs__msg__MultiArrayLayout(layout, 0), values.ravel()
    )


def _values(topic: str, message: Any, names: Sequence[str], dimensions: int) -> FloatArray:
    shape, label = (len(names),) * dimensions, ','.join(names)
    sizes = tuple(dimension.size for dimension in message.layout.dim)
    offset = message.layout.data_offset
    values = np.asarray(message.data, dtype=float)[offset:]
    if sizes != shape or values.size != np.prod(shape):
        raise MessageError(f'{topic}: {values.size} values in dimensions {sizes}; expected {shape}')
    if message.layout.dim[0].label != label:
        raise MessageError(f'{topic}: label {message.layout.dim[0].label!r}; expected {label!r}')
    return values.reshape(shape)
