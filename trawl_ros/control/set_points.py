# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Set points from outside: checked against limits, and dropped after a timeout."""

import math
from dataclasses import dataclass

from trawl_ros.core.time import SECOND


@dataclass(frozen=True)
class SetPointLimits:
    """Limits of set points, SI.

    Attributes
    ----------
    min_length, max_length
        Length of a warp, m.
    max_step
        Largest difference (m) between a wanted length and the counter.
    max_speed
        Speed of the ship through the water, m/s.
    max_turn
        Rate of turn, rad/s.
    timeout_ns
        Silence after which the warps are held at their lengths, ns.
    """

    min_length: float = 50.0
    max_length: float = 2000.0
    max_step: float = 50.0
    max_speed: float = 4.0
    max_turn: float = 0.02
    timeout_ns: int = 10 * SECOND


class SetPointGuard:
    """Guard between set points and winches.

    Parameters
    ----------
    limits
        Limits of the set points.
    """

    def __init__(self, limits: SetPointLimits) -> None:
        self._limits = limits
        self._counters = (math.nan, math.nan)
        self._heard: int | None = None

    def see(self, lengths: tuple[float, float]) -> None:
        """Record the counters, m, port first."""
        self._counters = lengths

    @property
    def active(self) -> bool:
        """True while set points arrive."""
        return self._heard is not None

    def warps(self, wanted: tuple[float, float], now: int) -> tuple[float, float]:
        """Check wanted lengths (m, NaN for a side without a change) at a time, ns.

        Raises
        ------
        ValueError
            If a length is outside the limits, or its counter is not known yet; no set point is
            then passed on.
        """
        # Sentences name no found value: nodes count refusals by their text.
        low, high = self._limits.min_length, self._limits.max_length
        for side, length, counter in zip(
            ('port', 'starboard'), wanted, self._counters, strict=True
        ):
            if math.isnan(length):
                continue
            if not low <= length <= high:
                raise ValueError(f'{side} warp: expected {low:g} to {high:g} m')
            if math.isnan(counter):
                raise ValueError(f'{side} warp: expected a reading of its counter first')
            if abs(length - counter) > self._limits.max_step:
                raise ValueError(
                    f'{side} warp: expected at most {self._limits.max_step:g} m from its counter'
                )
        self._heard = now
        return wanted

    def ship(self, speed: float, turn: float) -> tuple[float, float]:
        """Check a wanted speed (m/s) and rate of turn (rad/s).

        Raises
        ------
        ValueError
            If one is outside the limits or missing.
        """
        if not 0.0 <= speed <= self._limits.max_speed:
            raise ValueError(f'speed: expected 0 to {self._limits.max_speed:g} m/s')
        if not abs(turn) <= self._limits.max_turn:
            raise ValueError(f'rate of turn: expected at most {self._limits.max_turn:g} rad/s')
        return speed, turn

    def silence(self, now: int) -> tuple[float, float] | None:
        """Return the lengths to hold, once, after the timeout; None otherwise."""
        if self._heard is None or now - self._heard <= self._limits.timeout_ns:
            return None
        self._heard = None
        return self._counters
