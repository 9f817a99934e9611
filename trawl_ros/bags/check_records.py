"""Records of a bag's check."""

from dataclasses import dataclass
from pathlib import Path

from trawl_ros.bags.sources import BagFacts


@dataclass(frozen=True)
class Finding:
    """Finding: a word for scripts, the topic ('' for the bag), and a sentence."""

    kind: str
    topic: str
    text: str


@dataclass(frozen=True)
class TopicCheck:
    """Check of one topic of a bag.

    ``group`` is '' for a topic of somebody else. Rates are in Hz, log times in ns; ``lag_s`` is
    the least and greatest log time after the header's stamp. What cannot be told is None.
    """

    topic: str
    type: str
    group: str
    count: int
    bytes: int
    rate: float | None
    usual_rate: float | None
    longest_gap_s: float | None
    gap_start: int | None
    backward: int
    duplicates: int
    lag_s: tuple[float, float] | None
    qos: str


@dataclass(frozen=True)
class BagCheck:
    """Check of a bag."""

    path: Path
    facts: BagFacts
    count: int
    start: int | None
    end: int | None
    damaged_chunks: int
    topics: tuple[TopicCheck, ...]
    missing: dict[str, tuple[str, ...]]
    findings: tuple[Finding, ...]

    @property
    def sound(self) -> bool:
        """True without any finding."""
        return not self.findings
