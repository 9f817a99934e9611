"""Sampling times by the stamps of truth alone, so that results do not depend on the machine."""

from trawl_ros.core.time import SECOND

TOLERANCE = 1_000
"""Stamps made from seconds in floating point are off by less than this (ns)."""

MOST_JITTER = 0.45
"""No sample is off its beat by more than this part of the period, so samples keep their order."""


class Sampler:
    """Sampler: decides at which stamps a sample is due.

    The first stamp is due; after it the multiples of the period since the first, each at the
    first stamp that reaches it. So the mean rate is kept however truth is paced, and truth
    slower than the sensor gives a sample at each stamp.

    Parameters
    ----------
    rate
        Samples per second.
    start_up
        Time (s) after the first stamp in which nothing is due.
    """

    def __init__(self, rate: float, start_up: float = 0.0) -> None:
        self._rate = rate
        self._start_up = round(start_up * SECOND)
        self._first = 0
        self._latest: int | None = None
        self._next = 0

    @property
    def first(self) -> int:
        """Stamp of the first truth (ns)."""
        return self._first

    def started_anew(self, stamp: int) -> bool:
        """Register a stamp (ns); True if it is the first, or lies before the last one."""
        anew = self._latest is None or stamp < self._latest
        self._latest = stamp
        if anew:
            self._first = stamp
            self._next = 0
        return anew

    def due(self, stamp: int, shift_s: float = 0.0) -> bool:
        """True if a sample is due at ``stamp`` (ns), which `started_anew` has registered.

        ``shift_s`` is how much later than on the beat the next sample is to be taken.
        """
        since = stamp + TOLERANCE - self._first - self._start_up
        most = MOST_JITTER / self._rate
        shift = round(min(max(shift_s, -most), most) * SECOND)
        if since < round(self._next * SECOND / self._rate) + shift or since < 0:
            return False
        self._next = max(self._next + 1, int((since - shift) * self._rate / SECOND) + 1)
        return True
