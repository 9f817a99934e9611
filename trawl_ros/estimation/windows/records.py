# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of steady windows and rejections, and the options that decide on both."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from trawl_ros.core.errors import TrawlError
from trawl_ros.effects.base.effect import sense
from trawl_ros.estimation.windows.over_ground import GroundTrack
from trawl_ros.records.channels import CHANNELS

REASONS = {
    'not finite': 'readings that are NaN or infinite',
    'out of range': 'readings outside what channel or sensor can say, and stretches full of them',
    'outlier': 'readings far from the median of their window, and stretches full of them',
    'out of order': 'readings stamped before others of their channel that came earlier',
    'duplicate stamp': 'readings with the stamp of another of their channel',
    'late': 'readings that came when the windows they belong to were decided',
    'clock jump': 'readings whose stamps leap ahead for a moment, or far back',
    'silence': 'readings of the first half minute after a long silence of their channel',
    'frozen': 'stretches with a sensor that repeats one value',
    'gap': 'stretches with a sensor that falls silent',
    'missing channel': 'stretches without a channel that is needed',
    'turning': 'stretches while or soon after the ship turns',
    'unsteady': 'stretches while the gear is moved, settles or drifts',
    'wrong unit': 'windows with channels that are plausible in another unit only',
    'implausible': 'windows with channels that contradict each other, whatever the board',
    'speed over ground': 'windows of tows whose speed log does not see the current',
    'no steady state': 'windows for which the model finds no steady state',
}
"""Every reason for a rejection, and what its count counts."""


MAY_BE_ZERO = (
    'settle_s', 'settle_passages', 'net_length', 'longest_settle_s', 'slow_s', 'reorder_s',
)  # fmt: skip


@dataclass(frozen=True)
class WindowOptions:
    """Options of the window finder: criteria of steadiness.

    Attributes
    ----------
    settle_s, settle_passages, net_length
        Time the gear is given after the last change of warp length, speed or heading: at least
        ``settle_s`` (s), and so long that the ship tows ``settle_passages`` times the length of
        the gear, warp and ``net_length`` (m), for a change runs down the gear at towing speed.
    longest_settle_s
        No more than this (s) is asked.
    window_s
        Length (s) of a window.
    block_s
        Grid (s) on which windows lie; commands are judged by medians over one block.
    max_windows_per_state
        Windows taken of one long steady state; they do not overlap.
    length_tolerance
        Largest departure (m) of a block's warp length from the window's mean.
    speed_tolerance
        Largest departure (m/s) of a block's speed.
    heading_tolerance
        Largest departure (rad) of a block's heading; also the turn (rad) that a steady yaw
        rate may make in one window.
    drift_fraction
        A drift over the window beyond this part of the mean, and significant, is a trend.
    significance
        p-value below which a trend counts as significant.
    slow_s
        Time (s) in which the gear's slowest response decays: a channel that still drifts in a
        window is taken to be that many seconds of its drift away from where it will rest.
    outlier_limit
        Robust standard deviations from the median at which a reading is an outlier.
    outlier_fraction
        Part of a window's readings that may be outliers; beyond it the channel is not used.
    frozen_count
        Identical successive readings, at least, that make a sensor frozen, if they are also
        half of its readings or more.
    reorder_s
        Lateness (s) up to which the readings of one channel may overtake each other; more than
        2 s delays the windows, for which see `Channel.delay`.
    patience_s
        A window is decided without a channel that lags the winch by more than this (s) beyond
        its delay. Channels may come by half of this before or after each other without any
        effect on the windows.
    tow_gap_s
        Time (s) without warp lengths after which a new tow begins.
    """

    settle_s: float = 180.0
    settle_passages: float = 1.8
    net_length: float = 200.0
    longest_settle_s: float = 1800.0
    window_s: float = 60.0
    block_s: float = 10.0
    max_windows_per_state: int = 2
    length_tolerance: float = 1.0
    speed_tolerance: float = 0.08
    heading_tolerance: float = 0.06
    drift_fraction: float = 0.005
    significance: float = 0.001
    slow_s: float = 300.0
    outlier_limit: float = 6.0
    outlier_fraction: float = 0.2
    frozen_count: int = 10
    reorder_s: float = 2.0
    patience_s: float = 60.0
    tow_gap_s: float = 1800.0

    def __post_init__(self) -> None:
        for option in fields(self):
            value = getattr(self, option.name)
            if not value >= 0.0 or (value == 0.0 and option.name not in MAY_BE_ZERO):
                raise TrawlError(f'{option.name} is {value}, expected a positive number')
        if self.window_s < 2.0 * self.block_s:
            raise TrawlError(
                f'window_s is {self.window_s:g}, expected at least two blocks of {self.block_s:g} s'
            )


@dataclass(frozen=True)
class SteadyWindow:
    """Steady window: one stretch of steady towing.

    ``index`` counts windows, ``state`` the steady states they belong to; ``start_ns`` and
    ``end_ns`` are header stamps. Per channel (SI): ``means``, ``noise`` the standard error of
    the mean from scatter and autocorrelation, ``bias`` the standard deviation of its calibration
    (`Channel.bias_std`), ``counts`` of readings in the mean. ``tow`` counts tows, through each of
    which the errors of calibration stay the same. ``track`` compares log and GPS, None where one
    of them or the compass is silent. ``to_come`` is how far channels that still drift may be from
    where they will rest. ``hours`` is the time from the beginning of the tow to the middle of the
    window. ``seabed`` is the depth (m) of the water under the ship, None where no echo sounder
    tells it.
    """

    index: int
    state: int
    start_ns: int
    end_ns: int
    means: Mapping[str, float]
    noise: Mapping[str, float]
    bias: Mapping[str, float]
    counts: Mapping[str, int]
    tow: int = 0
    track: GroundTrack | None = None
    seabed: float | None = None
    to_come: Mapping[str, float] = field(default_factory=dict)
    hours: float = 0.0

    @property
    def sense(self) -> float:
        """Course sense on the track: 1 or -1, 1 where the heading is not known."""
        return sense(None if self.track is None else self.track.heading)

    def std(self, channel: str, windows_in_state: int = 1) -> float:
        """Standard deviation of a channel's mean as one of several windows of a state.

        The bias, and what changes with the state, is common to all windows of a state, so their
        number must not wear it down.
        """
        shared = self.bias[channel] ** 2 + CHANNELS[channel].per_state ** 2
        return math.sqrt(self.own_noise(channel) ** 2 + windows_in_state * shared)

    def own_noise(self, channel: str, least: float = 0.0) -> float:
        """Standard deviation of a channel's error that no other window shares.

        Its noise is taken for ``least`` at least.
        """
        return math.hypot(max(self.noise[channel], least), self.to_come.get(channel, 0.0))


@dataclass(frozen=True)
class RejectedWindow:
    """Rejected window: its reason (a key of `REASONS`) and what exactly was found."""

    reason: str
    start_ns: int
    end_ns: int
    detail: str


class Rejections:
    """Rejections: counts and sentences by reason, a key of `REASONS`.

    Attributes
    ----------
    counts : Counter
        Reason → how often.
    sentences : dict
        Reason → what was found last, in one sentence.
    """

    def __init__(self) -> None:
        self.counts: Counter[str] = Counter()
        self.sentences: dict[str, str] = {}

    def add(self, reason: str, sentence: str, number: int = 1) -> None:
        """Count ``number`` rejections, which the sentence describes."""
        self.counts[reason] += number
        self.sentences[reason] = sentence
