"""Set points from outside: held to limits, and given up when they fall silent."""

import math
from dataclasses import dataclass

from trawl_ros.core.time import SECOND


@dataclass(frozen=True)
class SetPointLimits:
    """Limits of set points, SI.

    Attributes
    ----------
    min_length, max_length
        Of a warp, m.
    max_step
        Furthest (m) that a wanted length may be from what the counter shows.
    max_speed
        Of the ship through the water, m/s.
    max_turn
        Rate of turn, rad/s.
    timeout_ns
        Silence after which the warps are to be held as they are.
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
        Bounds of the set points that are passed on.
    """

    def __init__(self, limits: SetPointLimits) -> None:
        self._limits = limits
        self._counters = (math.nan, math.nan)
        self._heard: int | None = None

    def see(self, lengths: tuple[float, float]) -> None:
        """Take note of what the counters show, m, port first."""
        self._counters = lengths

    @property
    def active(self) -> bool:
        """True while set points come."""
        return self._heard is not None

    def warps(self, wanted: tuple[float, float], now: int) -> tuple[float, float]:
        """Check wanted lengths (m, NaN for a side that is to stay as it is) at a time, ns.

        Raises
        ------
        ValueError
            If one is beyond the limits, or counters are not known yet; nothing is to be done
            then.
        """
        low, high = self._limits.min_length, self._limits.max_length
        for side, length, counter in zip(
            ('port', 'starboard'), wanted, self._counters, strict=True
        ):
            if math.isnan(length):
                continue
            if not low <= length <= high:
                raise ValueError(f'a {side} warp beyond {low:g} to {high:g} m')
            if math.isnan(counter):
                raise ValueError(f'a {side} warp before its counter is known')
            if abs(length - counter) > self._limits.max_step:
                raise ValueError(
                    f'a {side} warp more than {self._limits.max_step:g} m from its counter'
                )
        self._heard = now
        return wanted

    def ship(self, speed: float, turn: float) -> tuple[float, float]:
        """Check a wanted speed (m/s) and rate of turn (rad/s).

        Raises
        ------
        ValueError
            If one is beyond the limits or missing.
        """
        if not 0.0 <= speed <= self._limits.max_speed:
            raise ValueError(f'a speed beyond 0 to {self._limits.max_speed:g} m/s')
        if not abs(turn) <= self._limits.max_turn:
            raise ValueError(f'a rate of turn beyond {self._limits.max_turn:g} rad/s')
        return speed, turn

    def silence(self, now: int) -> tuple[float, float] | None:
        """Give the lengths that are to be held, once, when set points have fallen silent."""
        if self._heard is None or now - self._heard <= self._limits.timeout_ns:
            return None
        self._heard = None
        return self._counters
