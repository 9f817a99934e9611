"""Histories of the lump's depth and the block's tension, and the difference of two."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray


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
