"""What a file of a bag gives, whatever its storage: messages, and what it says of them."""

from dataclasses import dataclass

from mcap.records import Message


@dataclass(frozen=True)
class Stored:
    """A message as it lies in the file, with its topic and type."""

    topic: str
    type: str
    message: Message


@dataclass(frozen=True)
class Definition:
    """What a channel says of its messages: encodings, and the definition of the type.

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
    """What ``metadata.yaml`` says of topics, in its order; definitions come without their text.

    ``files`` is how many files these are in.
    """

    topics: tuple[tuple[str, Definition], ...]
    files: int
