# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Manoeuvre of hauling and turning as smooth functions of time, and histories of it.

Any program can follow the manoeuvre; histories of two programs can be compared.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.towed_wire import WIRE


@dataclass(frozen=True)
class History:
    """History of a manoeuvre in one program.

    Attributes
    ----------
    times
        (n,) s, rising.
    depth
        (n,) of the lump, m.
    tension
        (n,) force on the block, N.
    seconds
        CPU time that the motion took, s.
    """

    times: FloatArray
    depth: FloatArray
    tension: FloatArray
    seconds: float

    @property
    def factor(self) -> float:
        """Speed over real time."""
        return float(self.times[-1] - self.times[0]) / self.seconds


@dataclass(frozen=True)
class Apart:
    """Largest and root-mean-square differences over time.

    They are shares of the reference's value at the same instant.
    """

    depth: float
    tension: float
    depth_rms: float
    tension_rms: float

    @property
    def largest(self) -> float:
        """The larger of both largest differences."""
        return max(self.depth, self.tension)


def apart(history: History, reference: History) -> Apart:
    """Compare two histories at the instants of the coarser one.

    Values of the finer history are interpolated linearly. NaN, where a program broke down, counts
    as an infinite difference.
    """
    times = min((history, reference), key=lambda one: len(one.times)).times
    shares = []
    for name in ('depth', 'tension'):
        of, to = (np.interp(times, one.times, getattr(one, name)) for one in (history, reference))
        with np.errstate(invalid='ignore', over='ignore'):
            share = np.abs(of / to - 1.0)
        shares.append(np.where(np.isfinite(share), share, np.inf))
    with np.errstate(over='ignore'):
        rms = [float(np.sqrt((share**2).mean())) for share in shares]
    return Apart(float(shares[0].max()), float(shares[1].max()), rms[0], rms[1])


TURN_RATE = float(np.radians(0.5))
"""Rate of turn of the ship, rad/s."""


@dataclass(frozen=True)
class Pace:
    """Rate that rises smoothly, stays constant, and falls smoothly.

    Attributes
    ----------
    start
        Time at which it starts, s.
    total
        Integral of the rate over time.
    top
        Largest rate.
    rise
        Duration of the rise, and of the fall, s.

    Notes
    -----
    The rise is half a cosine wave: a winch or a rudder gives no jerk that would ring in the wire.
    """

    start: float
    total: float
    top: float
    rise: float

    @property
    def end(self) -> float:
        """Time at which the rate is zero again, s."""
        return self.start + self.total / self.top + self.rise

    def rate(self, time: float) -> float:
        """The rate at one time."""
        ramp = min(time - self.start, self.end - time, self.rise)
        return 0.5 * self.top * (1.0 - cos(pi * max(ramp, 0.0) / self.rise))

    def covered(self, time: float) -> float:
        """Integral of the rate up to one time."""
        since, left = max(time - self.start, 0.0), max(self.end - time, 0.0)
        if since < self.rise:
            return self._swelling(since)
        if left < self.rise:
            return self.total - self._swelling(left)
        return self.top * (since - 0.5 * self.rise)

    def _swelling(self, since: float) -> float:
        return 0.5 * self.top * (since - self.rise / pi * sin(pi * since / self.rise))


@dataclass(frozen=True)
class WireManoeuvre:
    """Manoeuvre of ship and winch.

    Attributes
    ----------
    length
        Unstretched length at the start, m.
    speed
        Of the ship through still water, m/s, constant.
    haul
        Length over time, m; negative ``total`` and ``top`` haul in.
    turn
        Course over time, rad.
    duration
        s.
    """

    length: float
    speed: float
    haul: Pace
    turn: Pace
    duration: float

    def length_at(self, time: float) -> float:
        """Unstretched length, m."""
        return self.length + self.haul.covered(time)

    def length_rate(self, time: float) -> float:
        """Rate of the unstretched length, m/s, out positive."""
        return self.haul.rate(time)

    def velocity(self, time: float) -> FloatArray:
        """Velocity (3,) of the block, m/s."""
        course = self.turn.covered(time)
        return self.speed * np.array([cos(course), sin(course), 0.0])

    def track(self, times: FloatArray) -> FloatArray:
        """Places (n, 3) of the block at rising, closely spaced times, m; Simpson's rule."""
        ends = np.array([self.velocity(t) for t in times])
        middles = np.array([self.velocity(t) for t in 0.5 * (times[1:] + times[:-1])])
        steps = np.diff(times)[:, None] / 6.0 * (ends[:-1] + 4.0 * middles + ends[1:])
        return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def haul_and_turn() -> WireManoeuvre:
    """Haul 200 m at 0.5 m/s, then turn by 90° at 0.5°/s, each from and to a steady pace."""
    haul = Pace(start=20.0, total=-200.0, top=-0.5, rise=10.0)
    turn = Pace(start=haul.end + 55.0, total=pi / 2, top=TURN_RATE, rise=20.0)
    return WireManoeuvre(WIRE.length, WIRE.speed, haul, turn, duration=turn.end + 220.0)


def short_manoeuvre() -> WireManoeuvre:
    """Return a short version: 10 m of hauling and 20° of turn."""
    haul = Pace(start=5.0, total=-10.0, top=-0.5, rise=10.0)
    turn = Pace(start=haul.end, total=pi / 9, top=TURN_RATE, rise=20.0)
    return WireManoeuvre(WIRE.length, WIRE.speed, haul, turn, duration=turn.end + 10.0)
