# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Series of one channel's readings through a tow: false echoes and outliers set aside, noise."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import median_filter
from scipy.special import ndtri

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.motion.fallen import FallRecorder
from trawl_ros.estimation.windows.buffers import channel_buffers
from trawl_ros.estimation.windows.records import Rejections, WindowOptions
from trawl_ros.estimation.windows.statistics import MAD_TO_STD
from trawl_ros.estimation.windows.watermark import Watermark
from trawl_ros.records.channels import CHANNELS, INPUTS, Channel, readings
from trawl_ros.records.samples import AttitudeSample, Sample, WinchSample

WIDE, NARROW = 15, 7
"""Readings about whose median false echoes, and outliers, are sought: the fewer, the less the
start of a manoeuvre looks like one."""

ECHO_LIMIT, LIMIT = 4.0, 6.0
"""Robust std from the median at which a reading is an outlier: of acoustic distances, where false
echoes are many, and of other quantities."""

OUTLIERS = 0.25
"""Part of the readings that are outliers, at most, where there are no false echoes. Of waves that
are read once a second more than half lie at the median of their neighbours: by the median distance
from it their peaks would be outliers."""

OTHERS = float(ndtri(1.0 - 0.5 * OUTLIERS))
"""Normal std within which all others lie."""

CHANGE_S, MEDIAN_REACH_S, STANDS_M_S = 4.0, 6.0, 0.05
"""Time over which a counter's changes are taken, reach of their median, and speed below which a
winch stands, where no winch tells its speed."""

MOST_READINGS = 1_000_000
"""Readings of a channel: a day of ten a second."""

LEAST_PART = 0.2
"""Part of the stated std of a reading that its noise is at least: a coarse display hides it."""


@dataclass(frozen=True)
class Series:
    """Series of a channel's readings.

    Attributes
    ----------
    times, values : (n,) arrays
        s since the tow began; SI.
    noise
        Standard deviation of a reading about its neighbours.
    excluded
        Number of outliers and false echoes, which are not among them.
    """

    times: FloatArray
    values: FloatArray
    noise: float = 0.0
    excluded: int = 0

    def __len__(self) -> int:
        return len(self.times)

    @property
    def period_s(self) -> float:
        """Median time between readings, s."""
        return float(np.median(np.diff(self.times)))


@dataclass(frozen=True)
class TowReadings:
    """Readings of a tow.

    Attributes
    ----------
    start_ns
        Stamp from which times count, the first at which all inputs have been read.
    series
        Series of each channel that has readings enough.
    payout
        Series of the pay-out speeds (m/s) of both winches, by their counters where no winch tells.
    hours
        Since the tow began, where these are a part of one.
    fallen
        Times (s) of the readings of each board, port first, in which it has fallen.
    """

    start_ns: int
    series: Mapping[str, Series]
    payout: tuple[Series, Series]
    hours: float = 0.0
    fallen: tuple[FloatArray, ...] = ()

    @property
    def duration_s(self) -> float:
        """Time to which all inputs have been read, s."""
        return min(float(self.series[name].times[-1]) for name in INPUTS)


def series_of(channel: Channel, times: FloatArray, values: FloatArray, stated: float) -> Series:
    """Set outliers aside, and find the noise of a reading from second differences.

    Parameters
    ----------
    channel
        Its row of the table.
    times, values : (n,) arrays
        Readings, s and SI, in the order of their times.
    stated
        Std of a reading as its sensor states it.
    """
    kept = np.ones(len(values), dtype=np.bool_)
    echoes = bool(np.isfinite(channel.leap))
    if echoes:
        kept &= np.abs(values - _median(values, WIDE)) <= channel.leap
    kept[np.flatnonzero(kept)[~_inliers(values[kept], stated, echoes=echoes)]] = False
    excluded = int(np.count_nonzero(~kept))
    times, values = times[kept], values[kept]
    second = values[1:-1] - 0.5 * (values[:-2] + values[2:])
    noise = float(np.sqrt(np.mean(second**2) / 1.5)) if len(second) else stated
    return Series(times, values, max(noise, LEAST_PART * stated), excluded)


def _median(values: FloatArray, size: int) -> FloatArray:
    found: FloatArray = median_filter(values, size, mode='reflect')
    return found


def _inliers(values: FloatArray, stated: float, *, echoes: bool) -> BoolArray:
    if not len(values):
        return np.ones(0, dtype=np.bool_)
    away = np.abs(values - _median(values, NARROW))
    spread = max(MAD_TO_STD * float(np.median(away)), 0.5 * stated)
    if not echoes:
        spread = max(spread, float(np.quantile(away, 1.0 - OUTLIERS)) / OTHERS)
    return np.asarray(away <= (ECHO_LIMIT if echoes else LIMIT) * spread, np.bool_)


class TowRecorder:
    """Recorder of a tow's readings as its samples come.

    Parameters
    ----------
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    """

    def __init__(self, pressure_to_depth: Callable[[float], float]) -> None:
        self._depth = pressure_to_depth
        self._buffers = channel_buffers(WindowOptions(), Watermark(), Rejections(), MOST_READINGS)
        self._payout: dict[int, tuple[float, float]] = {}
        self._falls = FallRecorder(MOST_READINGS)

    @property
    def start_ns(self) -> int | None:
        """Stamp at which all inputs have been read; None before."""
        first = [self._buffers[name].first for name in INPUTS]
        return None if None in first else max(stamp for stamp in first if stamp is not None)

    @property
    def newest_ns(self) -> int:
        """Newest stamp of the winches that can be believed, 0 before any."""
        return self._buffers[INPUTS[0]].newest or 0

    def feed(self, sample: Sample) -> None:
        """Take a sample of any instrument."""
        for reading in readings(sample, self._depth):
            self._buffers[reading.channel].add(reading)
        if isinstance(sample, WinchSample) and np.all(np.isfinite(sample.speeds)):
            self._payout[sample.stamp] = sample.speeds
        elif isinstance(sample, AttitudeSample):
            self._falls.feed(sample)

    def readings(self, name: str, until_ns: int | None = None) -> TowReadings:
        """Readings so far.

        Parameters
        ----------
        name
            Of the tow, for errors.
        until_ns
            Stamp of the last reading that counts; all do where None.

        Raises
        ------
        TrawlError
            If counters or log are missing.
        """
        known, payout = {}, self._payout
        for channel, buffer in self._buffers.items():
            stamps, values, stds = buffer.all_readings()
            own = slice(until_ns and int(np.searchsorted(stamps, until_ns, 'right')))
            known[channel] = stamps[own], values[own], stds[own]
        if until_ns is not None:
            payout = {stamp: speeds for stamp, speeds in payout.items() if stamp <= until_ns}
        missing = [name for name in INPUTS if len(known[name][0]) < WIDE]
        if missing:
            topics = ', '.join(f'{name} ({CHANNELS[name].topic})' for name in missing)
            raise TrawlError(
                f'{name}: fewer than {WIDE} usable readings of {topics}, so the model cannot be '
                'towed along'
            )
        start = max(int(known[name][0][0]) for name in INPUTS)
        series = {
            channel: series_of(
                CHANNELS[channel], (stamps - start) / SECOND, values, float(np.median(stds))
            )
            for channel, (stamps, values, stds) in known.items()
            if len(stamps) >= WIDE
        }
        fallen = tuple((stamps - start) / SECOND for stamps in self._falls.stamps(until_ns))
        if len(payout) < WIDE:
            told = payout_by_counter(series[INPUTS[0]]), payout_by_counter(series[INPUTS[1]])
            return TowReadings(start, series, told, fallen=fallen)
        told_at = sorted(payout)
        times = (np.array(told_at, dtype=np.int64) - start) / SECOND
        port, starboard = np.array([payout[stamp] for stamp in told_at]).T
        told = Series(times, port), Series(times, starboard)
        return TowReadings(start, series, told, fallen=fallen)


def tow_readings(
    samples: Iterable[Sample], pressure_to_depth: Callable[[float], float], name: str
) -> TowReadings:
    """Read a tow.

    Parameters
    ----------
    samples
        Of all instruments.
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    name
        Of the tow, for errors.

    Raises
    ------
    TrawlError
        If counters or log are missing.
    """
    recorder = TowRecorder(pressure_to_depth)
    for sample in samples:
        recorder.feed(sample)
    return recorder.readings(name)


def payout_by_counter(counter: Series) -> Series:
    """Pay-out speed (m/s) by a counter.

    It is the median of the counter's changes, so that a counter that jumps moves no warp.
    """
    times, values = counter.times, counter.values
    later = np.searchsorted(times, times + CHANGE_S - 1e-6)
    first = np.flatnonzero(later < len(times))
    last = later[first]
    speeds = (values[last] - values[first]) / (times[last] - times[first])
    speeds = _median(speeds, 1 + 2 * round(MEDIAN_REACH_S / counter.period_s))
    speeds[np.abs(speeds) < STANDS_M_S] = 0.0
    return Series(0.5 * (times[first] + times[last]), speeds)


def about_line(times: FloatArray, values: FloatArray) -> FloatArray:
    """Readings (n,) less the line through them."""
    away = times - times.mean()
    square = float(away @ away)
    slope = float(away @ values) / square if square > 0.0 else 0.0
    left: FloatArray = values - values.mean() - slope * away
    return left
