# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Encoding of messages as CDR, as every ROS 2 middleware understands it, and decoding.

Nodes publish these bytes as they are and bags store them, so there is one encoder.
"""

import struct
from typing import Any

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from trawl_ros.core.errors import MessageError
from trawl_ros.messages.cdr_writer import Encoded

STORE = get_typestore(Stores.ROS2_JAZZY)
"""Type store: types are named 'package/msg/Name', and its classes are the project's messages."""

_EXAMPLE = 'sensor_msgs/msg/JointState'

DECODING_ERRORS = (SerdeError, struct.error, ValueError, IndexError, MemoryError)
"""Exceptions that generated decoders raise if the bytes do not match the type."""


def serialize(message: Any) -> bytes:
    """Encode a message as little-endian CDR with its 4-byte header."""
    if isinstance(message, Encoded):
        return message.data
    return bytes(STORE.serialize_cdr(message, message.__msgtype__))


def deserialize(data: bytes, type_name: str) -> Any:
    """Decode CDR bytes of a known type.

    Raises
    ------
    MessageError
        If the type is unknown or the bytes do not hold one message of that type.
    """
    if type_name not in STORE.types:
        raise MessageError(
            f'{type_name} is not a known message type; expected a name such as {_EXAMPLE}'
        )
    try:
        return STORE.deserialize_cdr(data, type_name)
    except DECODING_ERRORS as error:
        raise MessageError(f'{len(data)} bytes are not a {type_name}: {error}') from error


def type_hash(type_name: str) -> str:
    """Return the type hash (RIHS01) by which ROS 2 compares two definitions."""
    return STORE.hash_rihs01(type_name)


def message_definition(type_name: str) -> str:
    """Return the definition with those of all nested types, as bags carry it (ros2msg)."""
    text, _ = STORE.generate_msgdef(type_name, ros_version=2)
    return text
