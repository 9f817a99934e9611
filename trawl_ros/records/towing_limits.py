# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Limits of a tow, the same for files, commands, Python and messages."""

import math
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class TowingLimits:
    """Limits of what ship and winches can be commanded.

    Attributes
    ----------
    warp_m
        Shortest and longest warp, m.
    speed_m_s
        Lowest and highest speed through the water, m/s.
    turn_deg_s
        Fastest rate of turn to either side, deg/s.
    """

    warp_m: tuple[float, float] = (1.0, 3000.0)
    speed_m_s: tuple[float, float] = (0.5, 4.0)
    turn_deg_s: float = 3.0

    @property
    def turn(self) -> float:
        """Fastest rate of turn, rad/s, with an allowance for rounding."""
        return math.radians(self.turn_deg_s) + 1e-12

    def objection(
        self, lengths: Sequence[float | None], speed: float | None = None, turn_rate: float = 0.0
    ) -> str:
        """Return what is beyond the limits, or an empty text.

        Parameters
        ----------
        lengths, speed, turn_rate
            Warp lengths (m) and speed (m/s), None where nothing is wanted, and rate of turn
            (rad/s). NaN is beyond any limit.
        """
        for length in lengths:
            if length is not None and not self.warp_m[0] <= length <= self.warp_m[1]:
                low, high = self.warp_m
                return f'a warp length of {length:g} m; expected {low:g} to {high:g}'
        if speed is not None and not self.speed_m_s[0] <= speed <= self.speed_m_s[1]:
            low, high = self.speed_m_s
            return f'a speed of {speed:g} m/s; expected {low:g} to {high:g}'
        if not abs(turn_rate) <= self.turn:
            return (
                f'a rate of turn of {turn_rate:g} rad/s; expected at most '
                f'{math.radians(self.turn_deg_s):.4f} to either side'
            )
        return ''


LIMITS = TowingLimits()
"""Limits that apply to files, commands, Python and messages."""
