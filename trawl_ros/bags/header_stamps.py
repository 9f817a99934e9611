# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Header stamps of stored messages, read with the bag's own types."""

from array import array
from collections.abc import Callable, Collection

import numpy as np

from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError
from trawl_ros.core.stamps import StampJudgement, judge_stamps
from trawl_ros.messages.stamps import stamp_in

StampReader = Callable[[bytes], int | None]

_HEADER = 'std_msgs/msg/Header'


def stamp_reader(bag: Bag, topic: str) -> StampReader | None:
    """Make the reader of the stamp (ns) in a topic's bytes, without decoding the rest.

    Returns
    -------
    callable or None
        None where the type does not begin with a header or is not known. The callable gives
        None for bytes that are too short.
    """
    try:
        _, fields = bag.types_of(topic).fielddefs[bag.topics[topic]]
    except (BagError, KeyError):
        return None
    if not fields or fields[0][1][1] != _HEADER:
        return None
    return stamp_in


def judge_headers(bag: Bag, topics: Collection[str]) -> StampJudgement:
    """Check the header stamps of topics, by full name, in one pass through the bag."""
    readers = {topic: stamp_reader(bag, topic) for topic in bag.topics if topic in topics}
    stamps = array('q')
    for message in bag.raw(topics):
        reader = readers[message.topic]
        if reader and (stamp := reader(message.data)) is not None:
            stamps.append(stamp)
    return judge_stamps(np.array(stamps, dtype=np.int64))
