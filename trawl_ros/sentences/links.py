# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""State of live links: their clocks, the source of each topic, and rejected lines."""

from collections import Counter
from dataclasses import dataclass

from trawl_ros.core.foreign import one_line
from trawl_ros.core.stamps import Leaps
from trawl_ros.core.time import SECOND
from trawl_ros.sentences.codec import Spoken

LEAP_NS = 3600 * SECOND
"""Deviation (ns) from the expected time above which a time counts as a leap.

Data may arrive faster than they were measured, and with pauses.
"""


SILENT_NS = 15 * SECOND
"""Silence (ns) after which another source is used: acoustic sensors report every few seconds."""

MOST_REASONS = 40
"""Largest number of reasons that are counted separately, since senders choose the text."""

SHOWN = 100
"""Number of characters of a line that are kept."""

OTHERS = 'for other reasons'


class LinkClock:
    """Clock of a link, which follows the ship's time as a receiver does.

    A ship's clock reports once a second, and winches report ten times a second. Between two reports
    this clock advances with the receiver's own clock, but never reaches the next report. Readings
    therefore keep their order if data arrive faster than they were measured. A time that leaps is
    used once three in a row agree.
    """

    def __init__(self) -> None:
        self._leaps: Leaps[None] = Leaps(LEAP_NS)
        self._said: int | None = None
        self._heard_at = 0
        self._interval = SECOND

    def hear(self, said: int, arrived: int) -> bool:
        """Take the time (ns) of a sentence that arrived at a monotonic time (ns).

        Return False if the time leaps and is not believed yet.
        """
        if not self._leaps.take(said - arrived, None)[0]:
            return False
        gone = said - self._said if self._said is not None else 0
        self._interval = gone if gone > 0 else SECOND
        self._said, self._heard_at = said, arrived
        return True

    def stamp(self, arrived: int) -> int | None:
        """Return the time (ns) at a monotonic time (ns); None before the first report."""
        if self._said is None:
            return None
        return self._said + min(max(arrived - self._heard_at, 0), self._interval - 1)


@dataclass(frozen=True)
class Source:
    """Source of readings.

    Attributes
    ----------
    link
        Name of the link, with the sender where several can speak on it.
    system, talker, form
        Of its sentences.
    rank
        Place of the row in its table; of two rows that tell a topic the first is preferred.
    """

    link: str
    system: str
    talker: str
    form: str
    rank: int

    def __str__(self) -> str:
        """Return its name for a reason."""
        return f'{self.link} {self.system} {self.talker} {self.form}'

    def is_instrument_of(self, other: 'Source') -> bool:
        """True if both belong to one system on one link."""
        return (self.link, self.system) == (other.link, other.system)

    def is_same(self, other: 'Source') -> bool:
        """True if the sentences of both complete each other."""
        same = (self.talker, self.form) == (other.talker, other.form)
        return same and self.is_instrument_of(other)


class SourceArbiter:
    """Choice of one source for each topic: the first one is used while it reports.

    Among the sentences of one system on one link the order of the table decides.
    """

    def __init__(self) -> None:
        self._told: dict[str, tuple[Source, int]] = {}

    def believed(self, spoken: Spoken, source: Source, now: int) -> tuple[Spoken, Source | None]:
        """Select the readings of a sentence whose topics its source may give.

        Parameters
        ----------
        spoken
            The sentence.
        source
            Its source.
        now
            Monotonic time, ns.

        Returns
        -------
        Spoken
            The sentence with these readings.
        Source or None
            Another instrument that gives a topic instead; None without one.
        """
        rival = None
        topics = []
        for topic in spoken.topics:
            owner, heard = self._told.get(topic, (source, now))
            preferred = source.is_instrument_of(owner) and source.rank < owner.rank
            if source.is_same(owner) or preferred or now - heard >= SILENT_NS:
                self._told[topic] = (source, now)
                topics.append(topic)
            elif source.form == owner.form or not source.is_instrument_of(owner):
                rival = owner
        return spoken.restricted(topics), rival


class Tally:
    """Counts of lines: how many were understood, and why others were rejected.

    Attributes
    ----------
    understood, foreign
        Lines that were, and whole sentences that no table has.
    reasons
        Counts by reason, at most `MOST_REASONS` and `OTHERS`.
    last
        The last line that was not, printable and cut, with its reason.
    """

    def __init__(self) -> None:
        self.understood = 0
        self.foreign = 0
        self.reasons: Counter[str] = Counter()
        self.last: tuple[str, str] | None = None

    def refuse(self, reason: str, line: bytes, count: int = 1) -> None:
        """Count rejected lines."""
        known = reason in self.reasons or len(self.reasons) < MOST_REASONS
        self.reasons[reason if known else OTHERS] += count
        if line:
            self.last = (one_line(line[: 2 * SHOWN].decode('latin-1').strip(), SHOWN), reason)

    @property
    def refused(self) -> int:
        """Number of rejected lines."""
        return self.reasons.total()
