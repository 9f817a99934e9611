# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Log of sentences from a bag, as a recorder on the ship's multiplexer writes it."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, islice
from pathlib import Path

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.errors import BagError
from trawl_ros.core.files import new_folder, written
from trawl_ros.core.limits import LOG_READINGS
from trawl_ros.records.fields import WaterColumn, fields_of_sample
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.sentences.table import SentenceTable, load_table
from trawl_ros.sentences.writer import SentenceWriter

CLOCK = 'ship'
"""System whose sentences state date and time."""


@dataclass(frozen=True)
class SentenceLog:
    """Written log.

    ``sentences`` are counts by address. ``silent`` are topics of the systems without a reading in
    the bag. ``problems`` are sentences on the faults of the bag.
    """

    sentences: Mapping[str, int]
    silent: tuple[str, ...]
    problems: tuple[str, ...]


def write_sentence_log(
    path: str | Path,
    tables: Sequence[SentenceTable],
    out: str | Path,
    *,
    water: WaterColumn,
    namespace: str = NAMESPACE,
    every_reading: bool = False,
) -> SentenceLog:
    """Write a bag's readings as sentences, in the order of their stamps.

    The ship's clock (``$GPZDA``) stands in front of the sentences of each instant, so that each
    has its time to the millisecond. Sentences end in carriage return and line feed.

    Parameters
    ----------
    path
        A bag's folder, or one file of it.
    tables
        Systems that speak.
    out
        File to be made.
    water
        By which pressures become depths.
    namespace
        Of the project's topics in this bag.
    every_reading
        True if each reading is written, also where a system sends them more seldom.

    Raises
    ------
    BagError
        If there is no bag, no reading that a system reports, or the file exists or cannot be
        written.
    """
    file = new_folder(Path(out), BagError)
    writer = SentenceWriter(tables, water, every_reading=every_reading)
    clock = SentenceWriter([load_table(CLOCK)], water)
    stream = SampleStream([Path(path)], namespace, topics=writer.topics)
    ordered = [sample for _, sample in islice(stream, LOG_READINGS.value + 1)]
    if len(ordered) > LOG_READINGS.value:
        raise BagError(f'{path}: more than {LOG_READINGS}; expected a bag in several parts')
    ordered.sort(key=lambda sample: sample.stamp)
    counts: Counter[str] = Counter()
    spoken: set[str] = set()
    with written(file) as draft:
        with draft.open('x', encoding='ascii', newline='') as lines:
            for stamp, together in groupby(ordered, lambda sample: sample.stamp):
                samples = list(together)
                if not (texts := writer.write(*samples)):
                    continue
                for text in (*clock.write_clock(stamp), *texts):
                    lines.write(f'{text}\r\n')
                    counts[text.partition(',')[0]] += 1
                spoken |= {topic for sample in samples if (topic := _told_by(sample))}
        if not counts:
            systems = ' and '.join(table.system for table in tables)
            raise BagError(
                f'{path}: no reading that {systems} reports; expected one of '
                f'{", ".join(writer.topics)}'
            )
    silent = tuple(topic for topic in writer.topics if topic not in spoken)
    return SentenceLog(counts, silent, tuple(stream.problems))


def _told_by(sample: Sample) -> str | None:
    """Topic of a sample that has a reading; None for one that has none."""
    topic, fields = fields_of_sample(sample) or (None, {})
    return topic if any(map(math.isfinite, fields.values())) else None
