"""Summary of a bag: counts of its content."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.bags.sources import BagFacts
from trawl_ros.core.time import SECOND


@dataclass(frozen=True)
class TopicSummary:
    """Summary of a topic: number, type and bytes of its messages, first and last time (ns)."""

    topic: str
    type: str
    count: int
    bytes: int
    start: int
    end: int

    @property
    def rate(self) -> float | None:
        """Mean rate, Hz; None where it is undefined."""
        span = self.end - self.start
        return (self.count - 1) * SECOND / span if span > 0 else None


@dataclass(frozen=True)
class BagSummary:
    """Summary of a bag; ``start`` and ``end`` are log times in ns, None without messages."""

    path: Path
    topics: tuple[TopicSummary, ...]
    count: int
    start: int | None
    end: int | None
    facts: BagFacts
    problems: tuple[str, ...]


def count_topics(messages: Iterable[tuple[str, str, int, int]]) -> tuple[TopicSummary, ...]:
    """Count messages, each given as topic, type, log time (ns) and size (bytes)."""
    summaries: dict[tuple[str, str], TopicSummary] = {}
    for topic, type_name, time, size in messages:
        key = topic, type_name
        past = summaries.get(key) or TopicSummary(*key, 0, 0, time, time)
        summaries[key] = TopicSummary(
            *key, past.count + 1, past.bytes + size, min(past.start, time), max(past.end, time)
        )
    return tuple(summaries[key] for key in sorted(summaries))
