"""Whether a sensor can be believed: reporting, lost, or frozen."""

import math
from collections import deque
from statistics import median

from trawl_ros.instruments.sampling import SECOND


class Watch:
    """Looks at one channel of a sensor and gives its reading while it can be believed.

    A single outlier does not come through: the reading is the median of the last three. A
    channel is *lost* when it gives no number for a while, and *frozen* when its number stays the
    same to the last digit although something it must follow has moved.

    Parameters
    ----------
    name
        Of the sensor, as people are told.
    lost_s
        How long it may give no number, s.
    frozen_after
        How far that which it must follow may move without any change of the number.

    Attributes
    ----------
    value : float
        The reading; NaN while the channel is not to be believed.
    problem : str
        What is wrong with it, '' if nothing.
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
        """Take a reading.

        Parameters
        ----------
        reading
            What the sensor says; NaN where it says nothing.
        stamp
            When, ns.
        followed
            Where that is which the sensor must follow.

        Returns
        -------
        bool
            Whether the reading is another than the one before.
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
