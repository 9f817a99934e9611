# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Settings and report of an autotrawl."""

import math
from dataclasses import dataclass
from typing import Literal

GIVE_LENGTH_M, FAST_S = 500.0, 0.2
"""Warp length for which the gains of the give are valid, and period of samples up to which."""

Mode = Literal['lengths', 'tension']


@dataclass(frozen=True)
class AutotrawlSettings:
    """Settings of an autotrawl.

    Parameters
    ----------
    mode
        'lengths' holds the set lengths by the counters. 'tension' holds both warps at equal
        tension, gives way to peaks, and holds the mean of the set lengths in the long run.
    tension
        Tension of one warp to hold (N); NaN for the mean of the last minutes.
    balance_gain
        Speed (m/s) at which warp moves from one side to the other per relative difference
        (T1 − T2) / (T1 + T2).
    balance_dead_band
        Relative difference below which no warp moves.
    give_gain
        Speed (m/s) at which `GIVE_LENGTH_M` of warp are paid out per relative excess of the
        tension. The gain is proportional to length, because a shorter warp is stiffer. It is
        reduced for samples slower than `FAST_S`, because late giving excites the swing.
    haul_gain
        Speed (m/s) of hauling back per relative lack of tension.
    give_dead_band
        Relative excess and lack below which nothing is given.
    haul_back_s
        Time in which given warp is hauled back at the wanted tension, s.
    max_give_m
        Largest length that is given, or hauled in, on one side.
    max_difference
        Largest difference between the warps by the balance, relative to their length.
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
class AutotrawlOptions:
    """Fixed options of an autotrawl's filters, watchdogs and slow parts.

    Attributes
    ----------
    max_gap_s
        Longest time step of the integrals: the time in a longer gap is unknown.
    balance_filter_s, mean_filter_s
        Time constants of the balanced tension, and of the mean from which peaks are counted.
    lost_s
        Time without a reading after which a sensor is lost.
    frozen_counter_m
        Change of the wanted length after which a constant counter is frozen.
    frozen_cell_changes, frozen_cell_travel_m
        A constant load cell is frozen after this many changes of the other cell, or after this much
        travel of the wanted lengths.
    counter_time_s, counter_max_speed, counter_dead_band_m
        Integral time, largest speed (m/s) and dead band of the counter's part.
    counter_max_error
        Largest error of a counter relative to the length, which also bounds its part.
    standstill_s, calm_s
        Times after the set length is reached until the winch stands still, and until the tension is
        no longer that of hauling or veering, to which nothing must be given.
    balance_max_speed
        Largest speed of the balance, m/s: the gear follows slowly.
    latency_s
        Latency of a sample and a command together.
    """

    max_gap_s: float = 2.0
    balance_filter_s: float = 10.0
    mean_filter_s: float = 120.0
    lost_s: float = 3.0
    frozen_counter_m: float = 2.0
    frozen_cell_changes: int = 20
    frozen_cell_travel_m: float = 1.0
    counter_time_s: float = 30.0
    counter_max_speed: float = 0.1
    counter_dead_band_m: float = 0.2
    counter_max_error: float = 0.05
    standstill_s: float = 10.0
    calm_s: float = 60.0
    balance_max_speed: float = 0.05
    latency_s: float = 0.3


@dataclass(frozen=True)
class AutotrawlState:
    """Report of an autotrawl: lengths in m, port first, and the relative difference of tension.

    ``difference`` is (T1 − T2) / (T1 + T2) of the smoothed tensions, NaN if one is missing.
    ``saturated`` names the parts at their bounds, ``problems`` the faults of sensors.
    """

    set_lengths: tuple[float, float]
    wanted: tuple[float, float]
    counter_parts: tuple[float, float]
    balance: float
    given: tuple[float, float]
    difference: float
    saturated: tuple[str, ...]
    problems: tuple[str, ...]
