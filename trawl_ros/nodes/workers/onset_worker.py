# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Worker thread that watches a tow in progress for effects that begin in it."""

from collections.abc import Callable
from threading import Lock
from typing import TYPE_CHECKING

from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.nodes.workers.worker import Worker
from trawl_ros.records.samples import Sample

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.monitor import OnsetMonitor

RESET = 'reset'
WATCHING = 'watching'


class OnsetWorker(Worker['Sample | str']):
    """Worker thread that feeds a monitor with samples in order of arrival.

    Parameters
    ----------
    monitor
        Nobody else may feed it from now on.
    on_finding
        Called in this thread with each finding that is new or has changed.
    dealt_with
        Called in this thread after each sample.
    """

    def __init__(
        self,
        monitor: 'OnsetMonitor',
        on_finding: Callable[[Finding], None],
        dealt_with: Callable[[Sample], None],
    ) -> None:
        super().__init__('onset')
        self._monitor, self._on_finding, self._dealt_with = monitor, on_finding, dealt_with
        self._using = Lock()

    @property
    def trouble(self) -> str:
        """Sentence of the last error; '' without one."""
        return self.troubles.get(WATCHING, '')

    def reset(self) -> None:
        """Begin a new tow after the queued samples."""
        self.put(RESET)

    def dismiss(self, number: int) -> Finding | None:
        """Dismiss a finding between two samples; None where there is no such open one."""
        with self._using:
            return self._monitor.dismiss(number)

    def do(self, work: Sample | str) -> None:
        """Feed a sample, or reset the monitor."""
        if isinstance(work, str):
            with self._using:
                self._monitor.reset()
            return
        self.attempt(WATCHING, lambda: self._feed(work))
        self._dealt_with(work)

    def _feed(self, sample: Sample) -> None:
        with self._using:
            findings = self._monitor.feed(sample)
        for found in findings:
            self._on_finding(found)
