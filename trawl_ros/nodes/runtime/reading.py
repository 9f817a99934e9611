"""Reading that a controller follows: decoded, and within what an instrument can report."""

from typing import Any

from trawl_ros.bags.possible import impossible
from trawl_ros.core.errors import MessageError
from trawl_ros.messages.from_messages import to_sample
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
