"""Headway of a node: the stamps of its data, and their rate against wall time."""

import time
from collections.abc import Callable

from trawl_ros.core.time import SECOND


class Headway:
    """Headway of the stamps that a node publishes or has dealt with.

    Parameters
    ----------
    clock
        Gives wall time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._latest: int | None = None
        self._gone = 0
        self._reported_at = clock()

    def reached(self, stamp: int) -> None:
        """Register a stamp (ns). An earlier one than before begins anew and counts nothing."""
        if self._latest is not None:
            self._gone += max(0, stamp - self._latest)
        self._latest = stamp

    def report(self) -> dict[str, str]:
        """Return key and value for diagnostics, with the factor since the last report.

        Nothing where no stamp was ever reached: such a node is not driven by stamps.
        """
        if self._latest is None:
            return {}
        now = self._clock()
        factor = self._gone / SECOND / max(now - self._reported_at, 1e-9)
        self._gone, self._reported_at = 0, now
        return {'data time': f'{self._latest / SECOND:.1f}', 'real-time factor': f'{factor:.2f}'}
