"""Timing of samples: rate, jitter, latency, dropouts and start-up."""

from dataclasses import dataclass

from trawl_ros.instruments.bursts import NO_BURSTS, BurstModel


@dataclass(frozen=True)
class Timing:
    """Timing of an instrument; times in s.

    ``rate`` in samples per second; ``jitter`` is the standard deviation with which samples are
    off the beat, ``latency`` the time from sampling to sending, ``start_up`` the time after
    switching on in which nothing is sampled; ``dropouts`` are spells in which nothing is sent.
    """

    rate: float
    jitter: float = 0.0
    latency: float = 0.0
    start_up: float = 0.0
    dropouts: BurstModel = NO_BURSTS
