# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Node by which a test takes part in its graph: it records, commands and hears diagnostics."""

from typing import Any

from trawl_ros.messages.diagnostics import OK, Status, read_statuses
from trawl_ros.messages.stamps import stamp_of
from trawl_ros.nodes.graph.graph_checks import elsewhere
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS
from trawl_ros.nodes.runtime.credit import ConsumerProgress
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.qos import CONSUMER
from trawl_ros.testing.recording import Recording

BENCH = 'bench'
PACE = 'truth/winch'
"""Topic by which the test follows the simulation."""


class Bench(TrawlNode):
    """Node of a test."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(BENCH, **kwargs)
        self.recordings: dict[str, Recording] = {}
        self.latest: dict[str, Status] = {}
        self.listen(DIAGNOSTICS, self._hear, CONSUMER)

    def follow(self) -> None:
        """Let the simulation wait for this node."""
        progress = ConsumerProgress(self)
        self.listen(PACE, lambda message: progress.done(stamp_of(message)), CONSUMER)

    def record(self, topic: str, type_name: str | None = None) -> Recording:
        """Record a topic from now on; a second call returns the same recording."""
        full = self.full_name(topic)
        if full not in self.recordings:
            recording = self.recordings[full] = Recording(full, self.silence)
            self.listen(topic, recording.messages.append, CONSUMER, type_name)
        return self.recordings[full]

    def silence(self, topic: str) -> str:
        """Return the reason why a topic (full name) may be silent."""
        names = sorted(info.node_name for info in self.get_publishers_info_by_topic(topic))
        if names:
            return f'published by {", ".join(names)}, but no message came'
        return 'nobody publishes it; expected one of the nodes of the graph to do so'

    def complaints(self) -> list[str]:
        """Return a line for each silent recording, and for each warning of a node."""
        lines = [one.explanation() for one in self.recordings.values() if not one.messages]
        lines += filter(None, [elsewhere(self, self.subscribed)])
        wrong = (status for status in self.latest.values() if status.level != OK)
        return lines + [f'{status.name}: {status.message}' for status in wrong]

    def _hear(self, message: Any) -> None:
        self.latest.update({status.name: status for status in read_statuses(message)})
