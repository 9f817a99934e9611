# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Writer of sentences: converts samples into the sentences that a system sends of them."""

from collections import defaultdict
from collections.abc import Sequence

from trawl_ros.core.time import SECOND
from trawl_ros.records.fields import WaterColumn, fields_of_sample
from trawl_ros.records.samples import Sample
from trawl_ros.sentences.codec import write_sentence
from trawl_ros.sentences.table import SentenceRow, SentenceTable


class SentenceWriter:
    """Writer of the sentences of some systems.

    Parameters
    ----------
    tables
        The systems.
    water
        By which pressures become depths.
    every_reading
        True if each reading is written, also where the system sends them more seldom.
    """

    def __init__(
        self,
        tables: Sequence[SentenceTable],
        water: WaterColumn,
        *,
        every_reading: bool = False,
    ) -> None:
        self._water = water
        self._every_reading = every_reading
        self._rows: dict[str, list[tuple[str, SentenceRow]]] = defaultdict(list)
        self._clocks: list[tuple[str, SentenceRow]] = []
        self._due: dict[str, int] = {}
        for table in tables:
            for name, row in table.sentences.items():
                if row.form:
                    continue
                key = f'{table.system} {name}'
                for topic in row.topics:
                    self._rows[topic].append((key, row))
                if row.is_clock:
                    self._clocks.append((key, row))

    @property
    def topics(self) -> tuple[str, ...]:
        """Topics for which sentences are written."""
        return tuple(self._rows)

    def write(self, *samples: Sample) -> list[str]:
        """Write the sentences of samples of one instant, without their ends.

        If a sentence holds readings of two topics, those of a topic sampled at another time stay
        empty. Samples without a sentence are not written.
        """
        readings: dict[tuple[str, str], float] = {}
        rows: dict[str, SentenceRow] = {}
        for sample in samples:
            if (taken := fields_of_sample(sample, self._water)) is None:
                continue
            topic, fields = taken
            readings |= {(topic, name): value for name, value in fields.items()}
            rows |= dict(self._rows.get(topic, ()))
        stamp = samples[0].stamp
        texts = []
        for key, row in rows.items():
            if not self._is_due(key, row, stamp):
                continue
            if (text := write_sentence(row, readings, stamp)) is not None:
                self._due[key] = stamp + round(row.least_interval_s * SECOND)
                texts.append(text)
        return texts

    def write_clock(self, stamp: int) -> list[str]:
        """Write the sentences that state date and time and nothing else."""
        texts = (write_sentence(row, {}, stamp) for _, row in self._clocks)
        return [text for text in texts if text is not None]

    def _is_due(self, key: str, row: SentenceRow, stamp: int) -> bool:
        if row.least_interval_s == 0.0 or self._every_reading:
            return True
        due = self._due.get(key)
        # A stamp far back belongs to a tow that has begun again.
        interval = round(row.least_interval_s * SECOND)
        return due is None or not due - 2 * interval < stamp < due
