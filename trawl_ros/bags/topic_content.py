# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Content of a topic's messages: whether they decode, are possible, and come from one source."""

import math
from collections import Counter
from dataclasses import dataclass

from trawl_ros.bags.one_source import Doubt, SourceWatch
from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.foreign import one_line
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import RangeSample

FIRST_MESSAGES = 20
"""Number of first messages of any topic that are decoded."""

ONE_IN = 25
"""Later messages that are not of an instrument: one in this many is decoded, to save time."""

REASON_CHARACTERS = 200
"""Longest quoted reason, characters."""


@dataclass(frozen=True)
class Finding:
    """Finding: a code for scripts, the topic ('' for the bag), and a sentence."""

    kind: str
    topic: str
    text: str


class TopicContent:
    """Check of the content of one of the project's topics.

    Parameters
    ----------
    name
        Its relative name.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._measured = name in SAMPLE_TOPICS
        self._watch = SourceWatch()
        self._doubt: Doubt | None = None
        self._seen = self._decoded = 0
        self._failed: Counter[str] = Counter()
        self._impossible: Counter[str] = Counter()
        self._reasons: dict[str, str] = {}

    def take(self, bag: Bag, message: RawMessage) -> None:
        """Add a message."""
        self._seen += 1
        if not self._measured and self._seen > FIRST_MESSAGES and self._seen % ONE_IN:
            return
        self._decoded += 1
        try:
            decoded = bag.decode(message)
        except BagError as reason:
            self._refuse('have a definition that is not understood', reason)
            return
        except MessageError as reason:
            self._refuse(f'are no {message.type}', reason)
            return
        if not self._measured:
            return
        try:
            sample = to_sample(self._name, decoded)
        except MessageError as reason:
            self._refuse('are no reading', reason)
            return
        # Infinite ranges say that nothing was within range.
        unlimited = isinstance(sample, RangeSample) and math.isinf(sample.distance)
        if not unlimited and (why := impossible(sample)):
            self._impossible[why] += 1
        if self._doubt is None:
            self._doubt = self._watch.take(message.channel, sample, message.sequence)

    def findings(self, topic: str) -> list[Finding]:
        """Yield the findings for the topic's full name."""
        found = [
            Finding('decode', topic, f'{count} of {self._decoded} messages looked at {what} (the '
                    f'first: {one_line(self._reasons[what], REASON_CHARACTERS)})')
            for what, count in self._failed.items()
        ]  # fmt: skip
        found += [
            Finding('value', topic, f'{count} readings are impossible: {why}')
            for why, count in self._impossible.items()
        ]
        if self._doubt is not None:
            found.append(Finding(self._doubt.kind, topic, self._doubt.text))
        return found

    def _refuse(self, what: str, reason: Exception) -> None:
        self._failed[what] += 1
        self._reasons.setdefault(what, str(reason))
