# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Messages of the bags of one tow on one time line, thinned out if there are many."""

import heapq
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.time import SECOND
from trawl_ros.records.topics import NAMESPACE, absolute

MOST_MESSAGES = 20_000
"""Largest number of messages of a topic; of more, only every second, third … is drawn."""

PROGRESS_EVERY = 500
"""Number of messages between two reports of progress."""


class TowMessage(NamedTuple):
    """Message of a tow: relative topic, log time (ns), and whether it is among those drawn."""

    topic: str
    log_time: int
    message: Any
    due: bool


class BagMessages:
    """Messages of the bags of one tow in the order of log times.

    Parameters
    ----------
    paths
        Folders or files: of a tow in parts, or of a tow and of what was estimated from it.
    namespace
        Of the project's topics in them.
    topics
        Relative names of those wanted.
    fewer
        Largest number of messages by topic, where it is not `MOST_MESSAGES`.

    Attributes
    ----------
    problems : list of str
        A sentence for each thing found wrong or left out; complete once all was read.
    counts : Counter
        Messages by relative topic.

    Raises
    ------
    BagError
        If one cannot be read, holds none of the topics, or two of them are of two tows.
    """

    def __init__(
        self,
        paths: Sequence[Path],
        namespace: str = NAMESPACE,
        *,
        topics: Collection[str],
        fewer: Mapping[str, int],
    ) -> None:
        self.paths = paths
        self.problems: list[str] = []
        self.counts: Counter[str] = Counter()
        names = {absolute(topic, namespace): topic for topic in topics}
        self._names = names
        self._bags = [Bag(path, namespace=namespace) for path in paths]
        spans: dict[str, list[tuple[int, int, Path]]] = {}
        for path, bag in zip(paths, self._bags, strict=True):
            for topic in bag.summary().topics:
                if topic.topic in names and topic.count:
                    self.counts[names[topic.topic]] += topic.count
                    spans.setdefault(topic.topic, []).append((topic.start, topic.end, path))
        if not self.counts:
            raise BagError(
                f'{paths[0]}: holds none of the topics that can be shown, expected '
                f'/{namespace.strip("/")}/winch/joint_states or others of the project; '
                '`trawl bag info` lists the topics of a bag, --namespace chooses others'
            )
        _refuse_two_tows(spans)
        every = [part for parts in spans.values() for part in parts]
        self._start, self._end = min(p[0] for p in every), max(p[1] for p in every)
        self.strides = {
            topic: -(-count // fewer.get(topic, MOST_MESSAGES))
            for topic, count in self.counts.items()
        }

    @property
    def topics(self) -> set[str]:
        """Relative names of the topics that there are."""
        return set(self.counts)

    @property
    def duration_s(self) -> float:
        """Time (s) from the first message to the last."""
        return (self._end - self._start) / SECOND

    def read(
        self,
        take: Callable[[TowMessage], None],
        *,
        all_of: Collection[str] = (),
        on_progress: OnProgress = ignore,
        stopped: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Pass each message to a function.

        Parameters
        ----------
        take
            Takes a message. If it raises `MessageError`, the message is left out and counted.
        all_of
            Topics of which all messages are passed on; of others only those that are due.
        on_progress
            Called as messages are read.
        stopped
            Asked now and then; True leaves out the rest.

        Returns
        -------
        bool
            True if all was read.
        """
        seen: Counter[str] = Counter()
        refused: Counter[str] = Counter()
        reasons: dict[str, str] = {}
        complete = True
        for number, (bag, raw) in enumerate(self._merged()):
            topic = self._names[raw.topic]
            due = seen[topic] % self.strides[topic] == 0
            seen[topic] += 1
            if due or topic in all_of:
                try:
                    take(TowMessage(topic, raw.log_time, bag.decode(raw), due))
                except MessageError as reason:
                    refused[topic] += 1
                    reasons.setdefault(topic, str(reason))
            if number % PROGRESS_EVERY == 0:
                done_s = (raw.log_time - self._start) / SECOND
                on_progress(WorkProgress('reading', done_s, self.duration_s, 's'))
                if stopped():
                    complete = False
                    break
        for bag in self._bags:
            self.problems += bag.problems
        self.problems += [
            f'{topic}: one of {stride} of its {self.counts[topic]} messages is shown'
            for topic, stride in self.strides.items()
            if stride > 1
        ]
        self.problems += [
            f'{count} messages were left out, the first because {reasons[topic]}'
            for topic, count in refused.items()
        ]
        return complete

    def _merged(self) -> Iterator[tuple[Bag, RawMessage]]:
        streams = [
            self._stream(bag) for bag in self._bags if not self._names.keys().isdisjoint(bag.topics)
        ]
        return heapq.merge(*streams, key=lambda entry: entry[1].log_time)

    def _stream(self, bag: Bag) -> Iterator[tuple[Bag, RawMessage]]:
        for raw in bag.raw(self._names):
            yield bag, raw


def _refuse_two_tows(spans: Mapping[str, list[tuple[int, int, Path]]]) -> None:
    """Reject bags that have one topic at the same time; ``spans`` are log times (ns) by topic."""
    for topic, parts in spans.items():
        parts.sort(key=lambda part: part[:2])
        for (_, end, first), (start, _, second) in pairwise(parts):
            if start <= end:
                raise BagError(
                    f'{first} and {second}: both have {topic} at the same time; expected bags of '
                    'one tow'
                )
