"""Readings of instruments: decoded, possible where a controller follows them, and of one source."""

from collections import defaultdict
from typing import Any

from trawl_ros.bags.one_source import SourceWatch
from trawl_ros.core.errors import MessageError
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample


def possible_sample(topic: str, message: Any) -> Sample:
    """Turn the message of an instrument topic into a sample.

    Raises
    ------
    MessageError
        If it contradicts the topic, or has a value that cannot be: one such would stay in all
        that is carried on from sample to sample.
    """
    sample = to_sample(topic, message)
    if reason := impossible(sample):
        raise MessageError(f'{topic}: {reason}')
    return sample


class OneSourceEach:
    """Check that each instrument topic of a node has one source.

    Two publishers are told apart by the numbers of their messages; what a player or a bridge
    passes on comes from one, and is told by its stamps and values.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Reset, as for a stream that begins anew."""
        self._watches: defaultdict[str, SourceWatch] = defaultdict(SourceWatch)

    def check(self, topic: str, sample: Sample) -> None:
        """Register a reading of a topic.

        Raises
        ------
        MessageError
            If those so far are of two sources, or their clock tells no time.
        """
        if doubt := self._watches[topic].take(0, sample):
            raise MessageError(f'{topic} {doubt.text}; it is not used')
