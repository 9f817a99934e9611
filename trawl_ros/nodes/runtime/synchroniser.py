"""Synchroniser of messages of several topics by equal stamps."""

from collections.abc import Sequence
from typing import Any

LONGEST_WAIT = 200
"""Instants that may be incomplete at a time; truth at 10 Hz is 20 s of them."""


class Joiner:
    """Synchroniser of topics that all carry every stamp.

    Each topic's stamps rise until time is set back; from there on they belong to the next run.
    So nothing is mixed up when one topic has begun a run that another has not come to yet.

    Parameters
    ----------
    topics
        Names of the topics to be joined.

    Attributes
    ----------
    incomplete : int
        Instants given up because a topic was missing.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        self._topics = tuple(topics)
        self._runs = dict.fromkeys(topics, 0)
        self._latest: dict[str, int] = {}
        self._waiting: dict[tuple[int, int], dict[str, Any]] = {}
        self.incomplete = 0

    def add(self, topic: str, stamp: int, message: Any) -> dict[str, Any] | None:
        """Add a message with its stamp (ns); return all of this stamp by topic once complete."""
        if stamp < self._latest.get(topic, stamp):
            self._runs[topic] += 1
        self._latest[topic] = stamp
        key = (self._run_of(topic, stamp), stamp)
        by_topic = self._waiting.setdefault(key, {})
        by_topic[topic] = message
        if len(by_topic) < len(self._topics):
            if len(self._waiting) > LONGEST_WAIT:
                # The one that waits longest: what false stamps have left behind may be ahead.
                self._give_up(next(iter(self._waiting)))
            return None
        for older in [other for other in self._waiting if other < key]:
            self._give_up(older)
        return self._waiting.pop(key)

    def _run_of(self, topic: str, stamp: int) -> int:
        """The run a message belongs to: the topic's own, unless only another awaits it.

        Who begins to listen while time is set back may hear the end of the run before on some
        topics only, and a single false stamp looks as if time were set back on its topic: their
        numbers would differ for ever.
        """
        own = self._runs[topic]
        awaiting = [
            run
            for (run, at), by_topic in self._waiting.items()
            if at == stamp and topic not in by_topic
        ]
        if awaiting and own not in awaiting and (own, stamp) not in self._waiting:
            self._runs[topic] = max(awaiting)
        return self._runs[topic]

    def _give_up(self, key: tuple[int, int]) -> None:
        del self._waiting[key]
        self.incomplete += 1
