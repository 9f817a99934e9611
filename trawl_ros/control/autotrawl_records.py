"""Settings and report of an autotrawl."""

import math
from dataclasses import dataclass
from typing import Literal

GIVE_LENGTH_M, FAST_S = 500.0, 0.2
"""For which length the give's gains are meant, and how often samples must come for them."""

Mode = Literal['lengths', 'tension']


@dataclass(frozen=True)
class AutotrawlSettings:
    """Settings of an autotrawl.

    Parameters
    ----------
    mode
        'lengths' holds the set lengths by the counters; 'tension' holds both warps at equal
        tension, gives way to peaks, and holds the mean of the set lengths in the long run.
    tension
        Tension of one warp that is to be held (N); NaN for the mean of the last minutes.
    balance_gain
        Speed (m/s) at which warp is moved from one side to the other per relative difference
        (T1 − T2) / (T1 + T2).
    balance_dead_band
        Relative difference at which nothing is moved.
    give_gain
        Speed (m/s) at which `GIVE_LENGTH_M` of warp are paid out per relative excess of the
        tension. A shorter warp is stiffer and gets less in proportion; and so does one whose
        samples come more seldom than `FAST_S`, for who gives way late feeds the swing.
    haul_gain
        Speed (m/s) at which it is hauled back per relative want of tension.
    give_dead_band
        Relative excess and want at which nothing is given.
    haul_back_s
        Time in which what was given is hauled back when the tension is as wanted, s.
    max_give_m
        Most that is given, or hauled in, on one side.
    max_difference
        Most difference between the warps that the balance makes, as a share of their length.
    max_speed, max_acceleration
        Limits of the winches, m/s and m/s².
    """

    mode: Mode = 'tension'
    tension: float = math.nan
    balance_gain: float = 0.5
    balance_dead_band: float = 0.004
    give_gain: float = 2.0
    haul_gain: float = 1.0
    give_dead_band: float = 0.02
    haul_back_s: float = 60.0
    max_give_m: float = 4.0
    max_difference: float = 0.02
    max_speed: float = 0.4
    max_acceleration: float = 0.1


@dataclass(frozen=True)
class AutotrawlState:
    """Report of an autotrawl: lengths in m, port first, and the relative difference of tension.

    ``difference`` is (T1 − T2) / (T1 + T2) of the smoothed tensions, NaN where one is missing;
    ``saturated`` names what is at its bound, ``problems`` what is wrong with sensors.
    """

    set_lengths: tuple[float, float]
    wanted: tuple[float, float]
    counter_parts: tuple[float, float]
    balance: float
    given: tuple[float, float]
    difference: float
    saturated: tuple[str, ...]
    problems: tuple[str, ...]
