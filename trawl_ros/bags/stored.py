"""Stored messages and definitions of a bag's file, whatever its storage."""

from dataclasses import dataclass

from mcap.records import Message


@dataclass(frozen=True)
class Stored:
    """Stored message of a file, with its topic and type."""

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
