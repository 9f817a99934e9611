"""Log time of recorded messages: the stamp of the header, or the time of receipt on its scale."""

from collections.abc import Iterator
from typing import Any

from trawl_ros.core.stamps import FAR_NS, Leaps, impossible_time

LONGEST_WAIT_NS = 2_000_000_000
"""Wall time (ns) for which messages without a usable stamp wait for one that has."""

MOST_WAITING = 1000
"""Messages that wait for it at most."""


class LogTimes:
    """Choice of log times.

    Stamps and the time of receipt differ by little, or by about the same: where a bag of last
    year is recorded again, by a year. A stamp that differs otherwise, as that of a driver that
    never stamps, is not used; its message is logged at the time of receipt, moved by what others
    differ by.

    Attributes
    ----------
    replaced
        Messages whose stamp was not used.
    """

    def __init__(self) -> None:
        self.replaced = 0
        self._offsets: Leaps[tuple[int, int | None, Any]] = Leaps(FAR_NS)
        self._offset: int | None = None
        self._waiting: list[tuple[int, int | None, Any]] = []
        self._since: int | None = None

    def take(self, stamp: int | None, received: int, message: Any) -> list[tuple[int, Any]]:
        """Take the next message, and give those that can be written, each with its log time.

        Parameters
        ----------
        stamp
            Of its header, ns; None without one.
        received
            Time of receipt, ns.
        message
            Anything that is to be had back.
        """
        if stamp is None or stamp == 0 or impossible_time(stamp):
            self._waiting.append((received, stamp, message))
            ready = []
        else:
            entry = (received, stamp, message)
            believed, false = self._offsets.take(stamp - received, entry)
            self._waiting += false
            ready = [(own, waited) for _, own, waited in believed]
            self._offset = stamp - received if believed else self._offset
        known = self._offset is not None
        return [*ready, *(self._release() if known or len(self._waiting) > MOST_WAITING else ())]

    def give_up(self, now: int, *, whole: bool = False) -> list[tuple[int, Any]]:
        """Give the messages that have waited for too long at a monotonic time (ns), or all."""
        if whole:
            self._waiting += self._offsets.give_up()
        if not self._waiting:
            self._since = None
            return []
        self._since = now if self._since is None else self._since
        return list(self._release()) if whole or now - self._since > LONGEST_WAIT_NS else []

    def _release(self) -> Iterator[tuple[int, Any]]:
        offset = self._offset or 0
        # Latency is no other scale.
        offset = offset if abs(offset) > FAR_NS else 0
        for received, stamp, message in self._waiting:
            log_time = max(received + offset, 0)
            if stamp is not None and 0 <= log_time - stamp <= FAR_NS:
                # The first instant of a simulation is 0.
                log_time = stamp
            elif stamp is not None:
                self.replaced += 1
            yield log_time, message
        self._waiting.clear()
