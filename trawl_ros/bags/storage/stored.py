"""Stored messages and definitions of a bag's file, whatever its storage."""

from dataclasses import dataclass
from typing import NamedTuple

from mcap.records import Message

from trawl_ros.core.errors import BagError
from trawl_ros.messages.cdr import STORE, message_definition, type_hash


class Stored(NamedTuple):
    """Stored message of a file, with its topic and type: a tuple, for there are many."""

    topic: str
    type: str
    message: Message


@dataclass(frozen=True)
class Definition:
    """Definition of a channel's messages: encodings, and the text of the type.

    ``qos`` is what publishers offered, as `bags.qos` reads it, ``type_hash`` the type's RIHS01;
    each '' where the bag does not say.
    """

    type: str
    message_encoding: str
    schema_encoding: str
    text: bytes
    qos: str = ''
    type_hash: str = ''


@dataclass(frozen=True)
class StatedTopics:
    """Topics of ``metadata.yaml`` in its order; definitions come without their text.

    ``files`` is how many files these are in.
    """

    topics: tuple[tuple[str, Definition], ...]
    files: int


def describe(type_name: str, qos: str) -> Definition:
    """Return the definition for a topic: its type's text and hash, and offered QoS.

    Raises
    ------
    BagError
        If the type's definition is unknown.
    """
    if type_name not in STORE.types:
        raise BagError(f'type {type_name}, whose definition is unknown')
    return Definition(
        type=type_name,
        message_encoding='cdr',
        schema_encoding='ros2msg',
        text=message_definition(type_name).encode(),
        qos=qos,
        type_hash=type_hash(type_name),
    )
