# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Diagnostic arrays: status of nodes, and findings of the diagnosis."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from rosbags.typesys.stores import ros2_jazzy as ros

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.stamps import header

OK = ros.diagnostic_msgs__msg__DiagnosticStatus.OK
WARN = ros.diagnostic_msgs__msg__DiagnosticStatus.WARN
ERROR = ros.diagnostic_msgs__msg__DiagnosticStatus.ERROR
STALE = ros.diagnostic_msgs__msg__DiagnosticStatus.STALE


@dataclass(frozen=True)
class Status:
    """Diagnostic status: a name, a level (`OK` to `STALE`), a short message, and values by key."""

    name: str
    level: int
    message: str
    values: Mapping[str, str] = field(default_factory=dict)
    hardware_id: str = ''


def diagnostic_array(
    stamp: int, statuses: Sequence[Status]
) -> ros.diagnostic_msgs__msg__DiagnosticArray:
    """Pack statuses into one message with a stamp in ns."""
    return ros.diagnostic_msgs__msg__DiagnosticArray(
        header(stamp, ''), [_to_message(status) for status in statuses]
    )


def read_statuses(message: Any) -> tuple[Status, ...]:
    """Read the statuses of a diagnostic array."""
    return tuple(
        Status(
            name=status.name,
            level=int(status.level),
            message=status.message,
            values={pair.key: pair.value for pair in status.values},
            hardware_id=status.hardware_id,
        )
        for status in message.status
    )


def read_number(status: Status, key: str) -> float:
    """Read a number from the values of a status.

    Raises
    ------
    MessageError
        If it is missing, or no finite number.
    """
    text = status.values.get(key, '')
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise MessageError(f'{status.name}: {key} is {text!r}; expected a number')
    return value


def _to_message(status: Status) -> ros.diagnostic_msgs__msg__DiagnosticStatus:
    return ros.diagnostic_msgs__msg__DiagnosticStatus(
        level=status.level,
        name=status.name,
        message=status.message,
        hardware_id=status.hardware_id,
        values=[
            ros.diagnostic_msgs__msg__KeyValue(key, value) for key, value in status.values.items()
        ],
    )
