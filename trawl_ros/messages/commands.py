# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Command messages to nodes: warp lengths, the ship's speed and rate of turn, and faults."""

import math
from typing import Any

import numpy as np
from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.pieces import TopicMessage, joint_column
from trawl_ros.messages.stamps import header
from trawl_ros.records.topics import TOPICS, WINCH_NAMES

WINCH_COMMAND = 'command/winch'
VESSEL_COMMAND = 'command/vessel'
FAULT_COMMAND = 'command/fault'


def winch_command(stamp: int, port: float, starboard: float) -> TopicMessage:
    """Build the message of commanded warp lengths (m); NaN leaves that winch unchanged."""
    wanted = zip(WINCH_NAMES, (port, starboard), strict=True)
    lengths = {name: float(length) for name, length in wanted if not math.isnan(length)}
    return WINCH_COMMAND, ros.sensor_msgs__msg__JointState(
        header(stamp, TOPICS[WINCH_COMMAND].frame),
        list(lengths),
        np.array(list(lengths.values()), dtype=float),
        np.zeros(0),
        np.zeros(0),
    )


def vessel_command(stamp: int, speed: float, yaw_rate: float) -> TopicMessage:
    """Build the message of a commanded speed and rate of turn.

    Speed is through the water, m/s; the rate of turn is positive to port, rad/s.
    """
    return VESSEL_COMMAND, ros.geometry_msgs__msg__TwistStamped(
        header(stamp, TOPICS[VESSEL_COMMAND].frame),
        ros.geometry_msgs__msg__Twist(
            ros.geometry_msgs__msg__Vector3(float(speed), 0.0, 0.0),
            ros.geometry_msgs__msg__Vector3(0.0, 0.0, float(yaw_rate)),
        ),
    )


def fault_command(where: str, what: str) -> TopicMessage:
    """Build the message of a fault at a topic or topic/quantity; 'none' ends all faults there."""
    return FAULT_COMMAND, ros.diagnostic_msgs__msg__KeyValue(where, what)


def read_fault_command(message: Any) -> tuple[str, str]:
    """Read place and kind of a fault; the node of the instrument checks them."""
    return message.key.strip().removeprefix('/'), message.value.strip()


def read_winch_command(message: Any) -> tuple[float | None, float | None]:
    """Read the commanded warp lengths (port, starboard), m; None for a winch that is not named.

    Raises
    ------
    MessageError
        If a name is not a winch's, none is there, or a length is not a positive number. A speed or
        a tension in place of a length is named.
    """
    wanted = joint_column(WINCH_COMMAND, message, 'position')
    unknown = [name for name in wanted if name not in WINCH_NAMES]
    if unknown or not wanted:
        raise MessageError(
            f'{WINCH_COMMAND}: names {list(message.name)}; expected {" and/or ".join(WINCH_NAMES)}'
        )
    for name, length in wanted.items():
        for field in ('velocity', 'effort') if math.isnan(length) else ():
            value = joint_column(WINCH_COMMAND, message, field)[name]
            if not math.isnan(value):
                raise MessageError(
                    f'{WINCH_COMMAND}: {field} {value:g} of {name} without a position; winches '
                    'take a warp length (position, m) and pay out at their own speed'
                )
        if not (math.isfinite(length) and length > 0):
            raise MessageError(
                f'{WINCH_COMMAND}: position {length:g} of {name}; expected a warp length above 0 m'
            )
    port, starboard = (wanted.get(name) for name in WINCH_NAMES)
    return port, starboard


def read_winch_speeds(message: Any) -> tuple[float, float]:
    """Read the greatest speeds (port, starboard), m/s, infinite where 0 or none is given.

    Raises
    ------
    MessageError
        If a speed is infinite.
    """
    given = joint_column(WINCH_COMMAND, message, 'velocity')
    for name, speed in given.items():
        if math.isinf(speed):
            raise MessageError(f'{WINCH_COMMAND}: velocity {speed:g} of {name}; expected m/s')
    # 0 is what is left where nobody sets it, and NaN is none.
    speeds = [abs(given.get(name, 0.0)) for name in WINCH_NAMES]
    port, starboard = (speed if speed > 0.0 else math.inf for speed in speeds)
    return port, starboard


def read_vessel_command(message: Any) -> tuple[float, float]:
    """Read the commanded speed through the water (m/s) and rate of turn (rad/s, positive to port).

    Raises
    ------
    MessageError
        If one of them is not a finite number.
    """
    speed, yaw_rate = float(message.twist.linear.x), float(message.twist.angular.z)
    if not (math.isfinite(speed) and math.isfinite(yaw_rate)):
        raise MessageError(
            f'{VESSEL_COMMAND}: linear.x {speed:g}, angular.z {yaw_rate:g}; '
            'expected finite numbers (m/s, rad/s)'
        )
    return speed, yaw_rate
