"""Pacer of simulated time at a factor of real time."""

import time
from collections.abc import Callable

LARGEST_DELAY_S = 1.0
"""Wall time that is made up for; what is beyond it is lost, so that no rush follows a pause."""


class Pacer:
    """Pacer of data time against wall time.

    Parameters
    ----------
    factor
        Data seconds per wall second; 0 sets no pace.
    clock
        Gives wall time in s.

    Attributes
    ----------
    lost_s : float
        Wall time (s) by which data fell behind for good.
    """

    def __init__(self, factor: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._factor = factor
        self._origin: tuple[float, float] | None = None
        self.lost_s = 0.0

    @property
    def factor(self) -> float:
        """Data seconds per wall second; 0 sets no pace."""
        return self._factor

    def change(self, factor: float) -> None:
        """Change the factor, from the present data time on."""
        self._factor = factor
        self._origin = None

    def restart(self) -> None:
        """Take the next data time as the present."""
        self._origin = None

    def due(self, data_s: float) -> bool:
        """True if data of this time (s) may be published."""
        if self._factor == 0.0:
            return True
        now = self._clock()
        if self._origin is None:
            self._origin = (now, data_s)
        wall, data = self._origin
        late = now - wall - (data_s - data) / self._factor
        if late > LARGEST_DELAY_S:
            self.lost_s += late
            self._origin = (now, data_s)
        return late >= 0.0
