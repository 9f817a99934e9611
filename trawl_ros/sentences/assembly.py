# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Assembly of samples from several sentences on one topic."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import FIELDS, Stated, WaterColumn, sample_of_fields
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.codec import Spoken
from trawl_ros.sentences.table import SentenceTable

TOGETHER_NS = SECOND // 2
"""Longest time (ns) between readings of one topic that form one sample."""

MOST_WAITING = 1000
"""Largest number of incomplete samples, one per topic and source."""


WINCH = 'winch/joint_states'
"""Topic on which an incomplete sample is used too."""


@dataclass
class _Part:
    """Fields of a sample received so far."""

    stamp: int
    fields: dict[str, float] = field(default_factory=dict)


class SampleAssembly:
    """Assembly of samples: pitch and roll, or the warps of both sides, come in several sentences.

    A sample is whole when every field is there that the system's sentences tell. It is given
    without the rest when a field comes again, or later than `TOGETHER_NS`: then a sentence was
    lost, or is not sent on that ship.

    Parameters
    ----------
    tables
        Systems.
    water
        By which depths become pressures.
    """

    def __init__(self, tables: Sequence[SentenceTable], water: WaterColumn) -> None:
        self._water = water
        self._forms: dict[tuple[str, str], str] = {}
        self._stated: dict[tuple[str, str], Stated] = {}
        self._told: dict[tuple[str, str, str], set[str]] = defaultdict(set)
        for table in tables:
            for sentence, row in table.sentences.items():
                self._forms[table.system, sentence] = row.form
                for topic, name in (one.target for one in row.fields if one.reading):
                    if topic in FIELDS:
                        self._told[table.system, row.form, topic].add(name)
                        self._stated[table.system, topic] = table.stated(topic, water)
        self._parts: dict[tuple[str, str, str, str], _Part] = {}

    def take(self, spoken: Spoken, stamp: int, source: str = '') -> list[Sample]:
        """Take a sentence in, and give the samples that are whole by it.

        Parameters
        ----------
        spoken
            The sentence.
        stamp
            Time of its readings, ns.
        source
            Tells apart where sentences come from: those of two links do not mix.
        """
        by_topic: dict[str, dict[str, float]] = defaultdict(dict)
        for (topic, name), value in spoken.readings.items():
            if topic in FIELDS:
                by_topic[topic][name] = value
        form = self._forms[spoken.system, spoken.name]
        samples: list[Sample | None] = []
        for topic, fields in by_topic.items():
            key = (source, spoken.system, form, topic)
            part = self._parts.get(key)
            if part is not None and (
                part.fields.keys() & fields.keys() or abs(stamp - part.stamp) > TOGETHER_NS
            ):
                samples.append(self._sample(key))
                part = None
            if part is None:
                if len(self._parts) >= MOST_WAITING:
                    samples.append(self._sample(next(iter(self._parts))))
                part = self._parts[key] = _Part(stamp)
            part.fields |= fields
            if part.fields.keys() >= self._told[spoken.system, form, topic]:
                samples.append(self._sample(key))
        return [sample for sample in samples if sample is not None]

    def flush(self, before: int | None = None) -> list[Sample]:
        """Return the incomplete samples, all or those stamped before a time (ns)."""
        keys = [key for key, part in self._parts.items() if before is None or part.stamp < before]
        return [sample for key in keys if (sample := self._sample(key)) is not None]

    def _sample(self, key: tuple[str, str, str, str]) -> Sample | None:
        _, system, form, topic = key
        part = self._parts.pop(key)
        if topic != WINCH and part.fields.keys() < self._told[system, form, topic]:
            return None
        stated = self._stated[system, topic]
        return sample_of_fields(topic, part.stamp, part.fields, stated, self._water)


def samples_of(spoken: Iterable[tuple[Spoken, int]], assembly: SampleAssembly) -> list[Sample]:
    """Yield the samples of sentences with their stamps (ns), in their order."""
    samples = [sample for item, stamp in spoken for sample in assembly.take(item, stamp)]
    return samples + assembly.flush()
