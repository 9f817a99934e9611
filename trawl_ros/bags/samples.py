# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Stream of samples from one or several bags, with the rejected messages."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from trawl_ros.bags.header_stamps import judge_headers
from trawl_ros.bags.one_source import SourceWatch
from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError, MessageError
from trawl_ros.messages.from_messages import SAMPLE_TOPICS, to_sample
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import absolute

BETWEEN_BAGS = 3_600_000_000_000
"""Time (ns) between two bags whose own stamps overlap, as those of simulations do."""


@dataclass
class SampleStream:
    """Stream of the samples of bags, in the order of log times within each.

    A bag that does not begin after the one before is shifted in time to follow it, so that tows
    stay separate, whatever their clocks were. Samples with impossible stamps are left out and
    counted. A bag with two sources on one topic is refused: which one is right is unknown, and an
    estimate from both would describe neither. A bag whose clock stands still or was set back is
    refused too.

    Attributes
    ----------
    topics
        Relative names of the topics that are read.
    problems
        A sentence for each thing that was found wrong; complete once all was read.
    """

    paths: Sequence[Path]
    namespace: str
    problems: list[str] = field(default_factory=list)
    topics: Sequence[str] = SAMPLE_TOPICS

    def __iter__(self) -> Iterator[tuple[Path, Sample]]:
        last = 0
        for path in self.paths:
            shift: int | None = None
            newest = last
            for sample in self._read(path):
                if shift is None:
                    behind = last and sample.stamp <= last
                    shift = last - sample.stamp + BETWEEN_BAGS if behind else 0
                moved = replace(sample, stamp=sample.stamp + shift) if shift else sample
                newest = max(newest, moved.stamp)
                yield path, moved
            last = newest

    def _read(self, path: Path) -> Iterator[Sample]:
        bag = Bag(path, namespace=self.namespace)
        names = {absolute(name, self.namespace): name for name in self.topics}
        if names.keys().isdisjoint(bag.topics):
            raise BagError(f'{path}: {_no_readings(bag, self.namespace, self.topics)}')
        refused: Counter[str] = Counter()
        reasons: dict[str, str] = {}
        watches = {name: SourceWatch() for name in self.topics}
        judged = judge_headers(bag, names)
        wrong = [f'{path}: {sentence}' for sentence in judged.sentences()]
        if judged.span is None and wrong:
            raise BagError(f'{"; ".join(wrong)}; expected the time of each reading')
        self.problems += wrong
        first, last = judged.span or (0, 0)
        for received in bag.messages(names):
            name = names[received.topic]
            try:
                sample = to_sample(name, received.message)
            except MessageError as reason:
                refused[name] += 1
                reasons.setdefault(name, str(reason))
                continue
            if not first <= sample.stamp <= last:
                continue
            if doubt := watches[name].take(received.channel, sample, received.sequence):
                raise BagError(f'{path}: {received.topic} {doubt.text}')
            yield sample
        self.problems += bag.problems
        for name, count in refused.items():
            self.problems.append(
                f'{path}: {count} messages were left out, the first because {reasons[name]}'
            )


def _no_readings(bag: Bag, namespace: str, topics: Sequence[str]) -> str:
    """Say where the readings of a bag may be, of which none is on these topics."""
    said = f'found no readings in /{namespace.strip("/")}'
    if others := _namespaces(bag, topics):
        return f'{said}, but in {" and ".join(others)}; expected --namespace {others[0].strip("/")}'
    names = sorted(bag.topics)
    found = f'topics such as {", ".join(names[:3])}' if names else 'no topic at all'
    return (
        f'{said}, but {found}; expected topics such as {absolute(topics[0], namespace)}. '
        '`trawl bag info` lists the topics of a bag; give a bag that recorded instruments'
    )


def _namespaces(bag: Bag, topics: Sequence[str]) -> list[str]:
    """Return the namespaces in which a bag has some of these topics, without their last slash.

    The truth of a simulation has topics of the same names, but is no reading.
    """
    ends = tuple(f'/{name}' for name in topics)
    found = (
        topic.removesuffix(end) or '/'
        for topic in bag.topics
        for end in ends
        if topic.endswith(end)
    )
    return [name for name in dict.fromkeys(found) if not name.endswith('/truth')]
