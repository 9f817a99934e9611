# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Display of bags: their messages become records, which go to a log."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

from trawl_ros.core.progress import OnProgress
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.from_messages import SAMPLE_TOPICS
from trawl_ros.plots.bag_messages import BagMessages, TowMessage
from trawl_ros.plots.moments import GEAR, IMAGE, SCAN, SECTION
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.view.reading import TOPICS, TowReader
from trawl_ros.view.records import Shown

MOST_PICTURES = 2_000
"""Largest number of gear shapes and sonar sweeps shown, since they are large."""

PICTURES = (GEAR, IMAGE, SCAN, 'sonar/points', SECTION)


class Log(Protocol):
    """Log of records."""

    def show(self, record: Shown) -> None:
        """Log a record."""

    def finish(self) -> None:
        """Pass on all waiting records; no more follow."""


class TowBags(BagMessages):
    """Bags of one tow on one time line, by their stamps; see `BagMessages`."""

    def __init__(self, paths: Sequence[Path], namespace: str = NAMESPACE) -> None:
        fewer = dict.fromkeys(PICTURES, MOST_PICTURES)
        super().__init__(paths, namespace, topics=TOPICS, fewer=fewer)

    def show(
        self,
        log: Log,
        gear: GearRecord,
        *,
        model: bool = False,
        on_progress: OnProgress,
        stopped: Callable[[], bool] = lambda: False,
    ) -> bool:
        """Show the tow in a log, in the order of log times.

        Parameters
        ----------
        log
            Takes the records.
        gear, model
            As for `TowReader`.
        on_progress, stopped
            As for `BagMessages.read`.

        Returns
        -------
        bool
            True if all was shown.
        """
        pictures = self.counts[GEAR] // self.strides.get(GEAR, 1) or MOST_PICTURES
        reader = TowReader(gear, self.duration_s / pictures, model=model)

        def take(given: TowMessage) -> None:
            records = reader.take if given.due else reader.model
            for record in records(given.topic, given.message):
                log.show(record)

        # Windows need all readings, however few of them are shown.
        every = SAMPLE_TOPICS if model else ()
        complete = self.read(take, all_of=every, on_progress=on_progress, stopped=stopped)
        if complete:
            for record in reader.finish():
                log.show(record)
        log.finish()
        return complete
