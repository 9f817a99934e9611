# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mean of one channel in one window, or the reason why it has none that can be used."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.units import UNITS
from trawl_ros.estimation.windows.buffers import ChannelBuffer
from trawl_ros.estimation.windows.operation import Unheld
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.estimation.windows.statistics import (
    error_of_mean,
    leaps,
    longest_run,
    outliers,
    trend,
)
from trawl_ros.estimation.windows.unit_errors import plausible_unit
from trawl_ros.estimation.windows.watermark import NANO
from trawl_ros.records.channels import Channel


@dataclass(frozen=True)
class ChannelMean:
    """Mean of ``count`` readings with its standard error ``noise``.

    Known too are how many outliers and false echoes were ``excluded``, and how far it may be from
    where it will settle.
    """

    mean: float
    noise: float
    count: int
    excluded: int
    to_come: float = 0.0


def channel_mean(
    buffer: ChannelBuffer, start_ns: int, end_ns: int, options: WindowOptions
) -> ChannelMean | Unheld:
    """Check a channel's readings in a window and average them."""
    channel = buffer.channel
    where = f'{channel.name} ({channel.topic})'
    stamps, values, stds = buffer.window(start_ns, end_ns)
    outside = buffer.outside(start_ns, end_ns)
    if len(outside) > options.outlier_fraction * (len(values) + len(outside)):
        return _outside(where, channel, outside)
    if not buffer.heard(end_ns):
        return Unheld('missing channel', f'{where} has not been heard')
    seconds = (stamps - (start_ns - buffer.delay)) / NANO
    edges = np.concatenate(([0.0], seconds, [(end_ns - start_ns) / NANO]))
    silence = float(np.max(np.diff(edges)))
    if len(stamps) == 0 or silence > channel.longest_gap:
        return Unheld('gap', f'{where} is silent for {silence:.1f} s')
    stated = float(np.median(stds))
    run = longest_run(values)
    if channel.lively and run >= options.frozen_count and 2 * run >= len(values):
        return Unheld('frozen', f'{where} repeats {values[-1]:g} {run} times')
    # False echoes first: they say nothing of the noise, whose outliers cast doubt on a mean.
    echoes, off = excluded_readings(values, stated, channel, options)
    false, excluded = int(np.count_nonzero(echoes)), int(np.count_nonzero(off))
    if 2 * false >= len(values):
        return Unheld('outlier', f'{where} has {false} false echoes in {len(values)} readings')
    if excluded > options.outlier_fraction * (len(values) - false):
        return Unheld(
            'outlier', f'{where} has {excluded} outliers in {len(values) - false} readings'
        )
    seconds, values = seconds[~(echoes | off)], values[~(echoes | off)]
    excluded += false
    mean = float(values.mean())
    noise, to_come = error_of_mean(values, stated), 0.0
    if channel.settles:
        change = trend(seconds, values)
        limit = max(options.drift_fraction * abs(mean), channel.bias)
        if change.p_value < options.significance and abs(change.drift) > limit:
            return Unheld(
                'unsteady',
                f'{where} drifts by {change.drift:.3g} {channel.unit} in one window, '
                f'at most {limit:.3g} {channel.unit} is steady',
            )
        # A slow decay has as much still to come as its slope brings in that time.
        to_come = change.beyond_noise * options.slow_s / options.window_s
    return ChannelMean(mean, noise, len(values), excluded, to_come)


def excluded_readings(
    values: FloatArray, stated: float, channel: Channel, options: WindowOptions
) -> tuple[BoolArray, BoolArray]:
    """Masks (n,) of a window's false echoes, and of the outliers among the others."""
    echoes = leaps(values, channel.leap)
    off = np.zeros(len(values), dtype=np.bool_)
    if not echoes.all():
        off[~echoes] = outliers(values[~echoes], stated, options.outlier_limit)
    return echoes, off


def _outside(where: str, channel: Channel, outside: FloatArray) -> Unheld:
    unit, reads = plausible_unit(outside, channel), float(np.median(outside))
    if unit is not None:
        return Unheld(
            'wrong unit',
            f'{where} looks like {unit}, expected {UNITS[channel.unit].name}: it reads {reads:.4g}',
        )
    return Unheld(
        'out of range',
        f'{where} reads {reads:.4g} {channel.unit}, expected {channel.low:g} to {channel.high:g}',
    )
