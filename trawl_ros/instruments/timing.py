"""When samples are taken and when they arrive."""

from dataclasses import dataclass

from trawl_ros.instruments.bursts import NO_BURSTS, BurstModel


@dataclass(frozen=True)
class Timing:
    """Times in s.

    ``rate`` in samples per second; ``jitter`` is the standard deviation with which samples are
    off the beat, ``latency`` the time from sampling to sending, ``start_up`` the time after
    switching on in which nothing is sampled; ``dropouts`` are spells in which nothing is sent.
    """

    rate: float
    jitter: float = 0.0
    latency: float = 0.0
    start_up: float = 0.0
    dropouts: BurstModel = NO_BURSTS
