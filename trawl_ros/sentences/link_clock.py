"""Clock of a link: the time that its sentences said last, and what has gone by since."""

from trawl_ros.core.stamps import Leaps
from trawl_ros.core.time import SECOND

LEAP_NS = 3600 * SECOND
"""A time further than this (ns) from the one expected leaps: data may come faster than they were
measured, and with pauses."""


class LinkClock:
    """Clock of a link, as a receiver of the ship's time keeps one.

    A ship's clock speaks once a second, and winches ten times. Between two times said this clock
    goes on with the receiver's own, but never as far as the next: where data come faster than
    they were measured, readings still keep their order. A time that leaps is believed when three
    in a row agree.
    """

    def __init__(self) -> None:
        self._leaps: Leaps[None] = Leaps(LEAP_NS)
        self._said: int | None = None
        self._heard_at = 0
        self._interval = SECOND

    def hear(self, said: int, arrived: int) -> bool:
        """Take the time (ns) of a sentence that arrived at a monotonic time (ns); false if it
        leaps, and is not believed yet.
        """
        if not self._leaps.take(said - arrived, None)[0]:
            return False
        gone = said - self._said if self._said is not None else 0
        self._interval = gone if gone > 0 else SECOND
        self._said, self._heard_at = said, arrived
        return True

    def stamp(self, arrived: int) -> int | None:
        """Give the time (ns) at a monotonic time (ns); None before any was said."""
        if self._said is None:
            return None
        return self._said + min(max(arrived - self._heard_at, 0), self._interval - 1)
