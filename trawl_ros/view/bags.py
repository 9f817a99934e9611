"""Bags shown: their messages read, thinned out where there are many, and given to a log."""

import heapq
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Protocol

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.core.progress import OnProgress, WorkProgress
from trawl_ros.core.time import SECOND
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.from_messages import SAMPLE_TOPICS
from trawl_ros.plots.moments import GEAR, IMAGE, SCAN
from trawl_ros.records.topics import NAMESPACE, absolute
from trawl_ros.view.reading import TOPICS, TowReader
from trawl_ros.view.records import Shown

MOST_MESSAGES = 20_000
"""Of one topic: where there are more, only every second, third … is shown."""

MOST_PICTURES = 2_000
"""The same for shapes of the gear and sweeps of the sonar, which are large."""

PICTURES = (GEAR, IMAGE, SCAN, 'sonar/points', 'truth/sonar/section')

PROGRESS_EVERY = 500
"""Messages."""


class Log(Protocol):
    """Log of records."""

    def show(self, record: Shown) -> None:
        """Log a record."""

    def finish(self) -> None:
        """Pass on all that waits; nothing more comes."""


@dataclass
class TowBags:
    """Bags of one tow, on one time line by the stamps that they have.

    Attributes
    ----------
    paths
        Folders or files: of a tow in parts, or of a tow and of what was estimated from it.
    namespace
        Of the project's topics in them.
    problems
        A sentence for each thing found wrong or left out; complete once all was shown.

    Raises
    ------
    BagError
        If one cannot be read, holds nothing that could be shown, or two of them are of two tows.
    """

    paths: Sequence[Path]
    namespace: str = NAMESPACE
    problems: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        names = {absolute(topic, self.namespace): topic for topic in TOPICS}
        self._names = names
        self._bags = [Bag(path, namespace=self.namespace) for path in self.paths]
        self._counts: Counter[str] = Counter()
        spans: dict[str, list[tuple[int, int, Path]]] = {}
        for path, bag in zip(self.paths, self._bags, strict=True):
            for topic in bag.summary().topics:
                if topic.topic in names and topic.count:
                    self._counts[names[topic.topic]] += topic.count
                    spans.setdefault(topic.topic, []).append((topic.start, topic.end, path))
        if not self._counts:
            raise BagError(
                f'{self.paths[0]}: holds none of the topics that can be shown; expected '
                f'{self.namespace}/winch/joint_states, {self.namespace}/truth/gear or others of '
                'the project'
            )
        for topic_name, parts in spans.items():
            parts.sort(key=lambda part: part[:2])
            for (_, end, first), (start, _, second) in pairwise(parts):
                if start <= end:
                    raise BagError(
                        f'{first} and {second}: both have {topic_name} at the same time; expected '
                        'bags of one tow'
                    )
        every = [part for parts in spans.values() for part in parts]
        self._start, self._end = min(p[0] for p in every), max(p[1] for p in every)

    @property
    def topics(self) -> set[str]:
        """Relative names of the topics in the bags that can be shown."""
        return set(self._counts)

    def show(
        self,
        log: Log,
        gear: GearRecord,
        *,
        model: bool = False,
        on_progress: OnProgress,
        stopped: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Give all that is to be shown to a log.

        Parameters
        ----------
        log
            Takes the records, in the order of log times.
        gear, model
            As for `TowReader`.
        on_progress
            Called as messages are read.
        stopped
            Asked now and then; where it says yes, the rest is left out.

        Returns
        -------
        bool
            True if all was shown.
        """
        strides = {topic: _stride(topic, count) for topic, count in self._counts.items()}
        duration = (self._end - self._start) / SECOND
        pictures = self._counts[GEAR] // strides.get(GEAR, 1) or MOST_PICTURES
        reader = TowReader(gear, duration / pictures, model=model)
        seen: Counter[str] = Counter()
        refused: Counter[str] = Counter()
        reasons: dict[str, str] = {}
        complete = True
        for number, (bag, raw) in enumerate(self._merged()):
            topic = self._names[raw.topic]
            seen[topic] += 1
            due = (seen[topic] - 1) % strides[topic] == 0
            # Windows need all readings, however few of them are shown.
            if due or (model and topic in SAMPLE_TOPICS):
                try:
                    take = reader.take if due else reader.model
                    for record in take(topic, bag.decode(raw)):
                        log.show(record)
                except MessageError as reason:
                    refused[topic] += 1
                    reasons.setdefault(topic, str(reason))
            if number % PROGRESS_EVERY == 0:
                on_progress(
                    WorkProgress('reading', (raw.log_time - self._start) / SECOND, duration, 's')
                )
                if stopped():
                    complete = False
                    break
        if complete:
            for record in reader.finish():
                log.show(record)
        log.finish()
        self._tell(strides, refused, reasons)
        return complete

    def _merged(self) -> Iterator[tuple[Bag, RawMessage]]:
        streams = [
            self._stream(bag) for bag in self._bags if not self._names.keys().isdisjoint(bag.topics)
        ]
        return heapq.merge(*streams, key=lambda entry: entry[1].log_time)

    def _stream(self, bag: Bag) -> Iterator[tuple[Bag, RawMessage]]:
        for raw in bag.raw(self._names):
            yield bag, raw

    def _tell(
        self, strides: Mapping[str, int], refused: Counter[str], reasons: Mapping[str, str]
    ) -> None:
        for bag in self._bags:
            self.problems += bag.problems
        self.problems += [
            f'{topic}: one of {stride} of its {self._counts[topic]} messages is shown'
            for topic, stride in strides.items()
            if stride > 1
        ]
        self.problems += [
            f'{count} messages were left out, the first because {reasons[topic]}'
            for topic, count in refused.items()
        ]


def _stride(topic: str, count: int) -> int:
    most = MOST_PICTURES if topic in PICTURES else MOST_MESSAGES
    return -(-count // most)
