# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""First-order low-pass filter of readings at uneven times."""

import math


class LowPass:
    """First-order low-pass filter; it starts at the first reading.

    Parameters
    ----------
    time_constant
        Time constant, s.

    Attributes
    ----------
    value : float
        Smoothed reading, NaN before the first.
    """

    def __init__(self, time_constant: float) -> None:
        self._time_constant = time_constant
        self.value = math.nan
        self._begun = False

    def take(self, reading: float, dt: float) -> None:
        """Update by a reading, ``dt`` seconds after the one before."""
        if not self._begun:
            self.value, self._begun = reading, True
            return
        # Exact step response, so uneven sample times do not matter.
        share = -math.expm1(-dt / self._time_constant)
        self.value = self.value + share * (reading - self.value)
