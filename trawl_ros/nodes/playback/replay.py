"""Replayed topics of a bag: those that can be published here, and their QoS."""

from collections.abc import Collection
from dataclasses import dataclass

from rclpy.qos import QoSProfile

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.messages.cdr import STORE, type_hash
from trawl_ros.nodes.playback.recorded_qos import offered_again
from trawl_ros.nodes.runtime.message_classes import message_class
from trawl_ros.nodes.runtime.qos import offered
from trawl_ros.records.topics import CLOCK, find_topic


@dataclass(frozen=True)
class Replayed:
    """Replayed topic: its type, its QoS, and whether that is as recorded."""

    type: str
    profile: QoSProfile
    as_recorded: bool


def replayed(
    bag: Bag, wanted: Collection[str], namespace: str
) -> tuple[dict[str, Replayed], list[str]]:
    """Select the topics of a bag to be played.

    Parameters
    ----------
    bag
        The bag.
    wanted
        Full names of the topics in the bag; none for all that can be played.
    namespace
        Of the project's topics.

    Returns
    -------
    topics
        By full name.
    left_out
        A sentence for each topic that cannot be played.

    Raises
    ------
    BagError
        If a topic that is wanted is not there or cannot be played, or none can.
    """
    definitions, recorded = bag.definitions(), bag.offered()
    # A new clock is made where one is wanted; an old one beside it would be a second.
    there = sorted(set(definitions) - {CLOCK.name})
    if missing := sorted(set(wanted) - set(there)):
        raise BagError(f'{bag.path}: no topic {", ".join(missing)}; there are: {", ".join(there)}')
    by_topic: dict[str, Replayed] = {}
    left_out = []
    for topic in there:
        if wanted and topic not in wanted:
            continue
        if reason := _hindrance(bag, topic, definitions[topic]):
            sentence = f'{bag.path}: {topic} cannot be played: {reason}'
            if wanted:
                raise BagError(sentence)
            left_out.append(sentence)
            continue
        usual = offered(find_topic(topic, namespace))
        again = offered_again(recorded[topic], usual)
        by_topic[topic] = Replayed(definitions[topic].type, again or usual, again is not None)
    if not by_topic:
        raise BagError('; '.join(left_out) or f'{bag.path}: no topic to be played')
    return by_topic, left_out


def _hindrance(bag: Bag, topic: str, definition: Definition) -> str:
    """Reason why the bytes of a topic have no meaning for subscribers here; '' without one."""
    name = definition.type
    try:
        message_class(name)
        another = name in STORE.types and definition.type_hash != type_hash(name)
        if another and bag.types_of(topic) is not STORE:
            return f'{name} was another type where it was recorded'
    except (MessageError, BagError) as reason:
        return str(reason)
    return ''
