"""Monitor of a running graph with a journal of truth and estimates."""

import time
from bisect import bisect_right
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from trawl_ros.core.time import SECOND
from trawl_ros.lab.running.delay_monitor import DelayMonitor
from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.nodes.identification_node import STATUS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER


class JournalMonitor(DelayMonitor):
    """Monitor of the wall time of each truth, and of the newest status of the estimate.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.

    Attributes
    ----------
    coefficients
        Values of the newest ``identification/status``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._stamps: list[int] = []
        self._walls: list[float] = []
        self.coefficients: Mapping[str, str] = {}

    def longest_silence_s(self) -> float:
        """Return the longest wall time (s) between two truths."""
        walls = self._walls
        return max((b - a for a, b in pairwise(walls)), default=0.0)

    def first_after(self, stamp: int) -> float | None:
        """Return the wall time at which the first truth after a stamp (ns) was heard."""
        index = bisect_right(self._stamps, stamp)
        return self._walls[index] if index < len(self._walls) else None

    def done_s(self, node: str) -> float:
        """Data time (s) that a consumer has dealt with, by its last report."""
        return self._done.get(node, 0) / SECOND

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to the estimate, too."""
        super().listen_to_more(node)
        node.listen(STATUS, self._hear_status, CONSUMER)

    def _hear_truth(self, message: Any) -> None:
        stamp = stamp_of(message)
        # A stranger repeats what was there already.
        if not self._stamps or stamp > self._stamps[-1]:
            super()._hear_truth(message)
            self._walls.append(time.monotonic())
            self._stamps.append(stamp)

    def _hear_status(self, message: Any) -> None:
        self.coefficients = read_statuses(message)[0].values
