"""Fault detection of a sensor's channel: lost or frozen readings."""

import math
from collections import deque
from statistics import median

from trawl_ros.core.time import SECOND


class Watch:
    """Watchdog of one channel of a sensor; passes its reading while it is valid.

    A single outlier does not come through: the reading is the median of the last three. A
    channel is *lost* when it gives no number for a while, and *frozen* when its number stays the
    same to the last digit although something it must follow has moved.

    Parameters
    ----------
    name
        Of the sensor, as people are told.
    lost_s
        Time without a number after which it is lost, s.
    frozen_after
        Change of the followed quantity, without any of the number, after which it is frozen.

    Attributes
    ----------
    value : float
        The reading; NaN while the channel is not to be believed.
    problem : str
        Description of its fault, '' without one.
    """

    def __init__(self, name: str, *, lost_s: float, frozen_after: float) -> None:
        self.name = name
        self.value = math.nan
        self.problem = ''
        self._patience = round(lost_s * SECOND)
        self._frozen_after = frozen_after
        self._recent: deque[float] = deque(maxlen=3)
        self._heard: int | None = None
        self._followed_at_change = 0.0
        self._frozen = False

    def take(self, reading: float, stamp: int, followed: float) -> bool:
        """Update by a reading.

        Parameters
        ----------
        reading
            The sensor's number; NaN where it gives none.
        stamp
            Time of the reading, ns.
        followed
            Value of the quantity that the sensor must follow.

        Returns
        -------
        bool
            True if the reading differs from the one before.
        """
        if self._heard is None:
            self._heard = stamp
        silent = stamp - self._heard > self._patience
        if not math.isfinite(reading):
            if silent:
                self._give_up('lost')
            return False
        if silent:
            self._recent.clear()
        self._heard = stamp
        changed = not self._recent or reading != self._recent[-1]
        if changed:
            self._followed_at_change = followed
        self._recent.append(reading)
        if abs(followed - self._followed_at_change) > self._frozen_after:
            self._frozen = True
        self._frozen = self._frozen and not changed
        if self._frozen:
            self._give_up('frozen')
        else:
            self.problem = ''
            self.value = median(self._recent)
        return changed

    def _give_up(self, problem: str) -> None:
        self.problem = f'{self.name} {problem}'
        self.value = math.nan
