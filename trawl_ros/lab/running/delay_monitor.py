"""Monitor of a running graph that measures each node's delay behind the truth."""

from collections.abc import Mapping
from typing import Any

from trawl_ros.core.time import SECOND
from trawl_ros.lab.running.monitor import Monitor
from trawl_ros.messages.stamps import from_time, stamp_of
from trawl_ros.nodes.runtime.credit import HEADER, consumer_of
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.records.topics import SYNC

TRUTH = 'truth/winch'
"""The topic whose stamps are the simulation's present."""


class DelayMonitor(Monitor):
    """Monitor of diagnostics, truth and the nodes' reports on ``sync/progress``.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._truth: int | None = None
        self._done: dict[str, int] = {}

    @property
    def truth_s(self) -> float | None:
        """Stamp of the newest truth, s; None before the first."""
        truth = self._truth
        return None if truth is None else truth / SECOND

    def delays_s(self) -> dict[str, float]:
        """Delay of each node in data time (s) behind the newest truth."""
        truth = self._truth
        if truth is None:
            return {}
        return {node: (truth - done) / SECOND for node, done in list(self._done.items())}

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to truth and progress."""
        node.listen(TRUTH, self._hear_truth, CONSUMER)
        node.listen(SYNC, self._hear_progress, CONSUMER, HEADER)

    def _hear_truth(self, message: Any) -> None:
        self._truth = stamp_of(message)

    def _hear_progress(self, message: Any) -> None:
        self._done[consumer_of(message)[0]] = from_time(message.stamp)
