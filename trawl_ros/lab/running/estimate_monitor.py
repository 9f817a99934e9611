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

    What all of the tow tells has a stamp of its own there, the end of its newest half minute.

    Parameters
    ----------
    environment
        Environment variables of the graph's nodes, such as ``ROS_DOMAIN_ID``.
    """

    def __init__(self, environment: Mapping[str, str]) -> None:
        super().__init__(environment)
        self._heard_at: dict[int, int] = {}
        self._motion_heard_at: dict[float, int] = {}
        self._windows = 0

    @property
    def playing(self) -> bool:
        """True if the graph's clock has begun to run."""
        return self._node.now() > 0

    @property
    def windows(self) -> int:
        """Number of windows that the newest estimate has used."""
        return self._windows

    def delays_s(self) -> list[float]:
        """Time (s) on the graph's clock from each window's end to the estimate with it."""
        return [(heard - end) / SECOND for end, heard in sorted(self._heard_at.items())]

    def motion_delays_s(self) -> list[float]:
        """Time (s) on the graph's clock from the end of each half minute of a tow that was learned
        from to the estimate with it.
        """
        found = sorted(self._motion_heard_at.items())
        return [heard / SECOND - end for end, heard in found]

    def listen_to_more(self, node: TrawlNode) -> None:
        """Listen to the status."""

        def hear(message: Any) -> None:
            coefficients, *others = (status.values for status in read_statuses(message))
            # Of all others that of all of the tow alone has a stamp.
            for values in others:
                if 'stamp' in values:
                    self._motion_heard_at.setdefault(float(values['stamp']), node.now())
            self._windows = int(coefficients['windows'])
            if self._windows:
                # A refused window brings a status too, with the stamp of the estimate there is.
                self._heard_at.setdefault(stamp_of(message), node.now())

        node.listen(STATUS, hear, CONSUMER)
