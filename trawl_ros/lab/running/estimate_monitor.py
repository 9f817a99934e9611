"""Monitor of a running graph that records the arrival of each new estimate."""

from collections.abc import Mapping
from typing import Any

from trawl_ros.core.time import SECOND
from trawl_ros.lab.running.monitor import Monitor
from trawl_ros.messages.diagnostics import read_statuses
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.nodes.identification_node import STATUS
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER


class EstimateMonitor(Monitor):
    """Monitor of `identification_node`'s status, whose stamp is the end of the newest window.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._heard_at: dict[int, int] = {}

    @property
    def playing(self) -> bool:
        """True if the graph's clock has begun to run."""
        return self._node.now() > 0

    @property
    def windows(self) -> int:
        """Number of windows that have led to an estimate."""
        return len(self._heard_at)

    def delays_s(self) -> list[float]:
        """Time (s) on the graph's clock from each window's end to the estimate with it."""
        return [(heard - end) / SECOND for end, heard in sorted(self._heard_at.items())]

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to the status."""

        def hear(message: Any) -> None:
            coefficients = read_statuses(message)[0].values
            if coefficients['windows'] != '0':
                # A refused window brings a status too, with the stamp of the estimate there is.
                self._heard_at.setdefault(stamp_of(message), node.now())

        node.listen(STATUS, hear, CONSUMER)
