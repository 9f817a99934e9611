# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Swept area and volume of a haul, each with an interval, from the readings of a bag."""

import math
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import BagError, NoSteadyState
from trawl_ros.core.resources import packaged_bag
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.records.channels import CHANNELS, readings
from trawl_ros.records.observables import Observables
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.solver.equilibrium import steady_state

USED = (
    'door_spread', 'speed', 'vertical_opening', 'port_length', 'starboard_length',
    'ground_east', 'ground_north',
)  # fmt: skip
"""Channels that are used."""


Series = Mapping[str, tuple[FloatArray, FloatArray]]
"""Times (s) and values of the readings of each channel."""


@dataclass(frozen=True)
class SweptOptions:
    """Options of swept areas.

    Attributes
    ----------
    fishing_fraction
        The haul lasts from the first to the last time at which the warps have this fraction of
        their greatest length.
    neighbours, outlier_limit
        Readings on either side from whose median a reading is judged, and the number of robust
        standard deviations beyond which it is left out.
    width_half, height_half
        Relative errors that 95 % of modelled widths of the mouth over the door spread, and of its
        heights, stay within, from gears 100 to 139 of `test/api/test_swept.py`. That of the width
        is 1.96 std. Errors of the height have short tails: 0.27 is their 95 % quantile, and 1.96
        std, 0.31, would hold nearly all of them.
    sensor_stds
        Standard deviations that hold 95 % of a sensor's errors.
    step_s
        Time step of the integrals, about, s.
    """

    fishing_fraction: float = 0.5
    neighbours: int = 10
    outlier_limit: float = 4.0
    width_half: float = 0.05
    height_half: float = 0.27
    sensor_stds: float = 1.96
    step_s: float = 2.0


OPTIONS = SweptOptions()


@dataclass(frozen=True)
class SweptValue:
    """Quantity of a haul in its ``unit``, and where it comes from.

    The truth is within ``half_width`` of the value in 95 % of the hauls.
    """

    name: str
    value: float
    half_width: float
    unit: str
    source: str

    @property
    def interval(self) -> tuple[float, float]:
        """Interval that contains the truth in 95 % of the hauls."""
        return self.value - self.half_width, self.value + self.half_width


def swept(
    bag: str | Path, gear: str | Path = 'kaifuha', *, namespace: str = NAMESPACE
) -> tuple[SweptValue, ...]:
    """Compute distances, swept areas and volume of a haul.

    Parameters
    ----------
    bag
        Recording of one haul.
    gear
        File, or name of a gear of the package, for what was not measured.
    namespace
        Namespace of the topics.

    Returns
    -------
    tuple of SweptValue
        Distances (m), means (m), areas (m²) and volume (m³).

    Raises
    ------
    BagError
        If warps, door spread or a speed are missing, or the bag cannot be read.
    NoSteadyState
        If the model that is needed has no steady state at the mean of the haul.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.api.swept import swept
    >>> for one in swept('sea_trial')[:1]:
    ...     print(one.name, one.unit, one.source)
    distance over ground m measured
    """
    stream = SampleStream(
        [packaged_bag(bag)], namespace, topics=[CHANNELS[name].topic for name in USED]
    )
    try:
        return swept_of_samples((sample for _, sample in stream), load_gear(gear))
    except BagError as reason:
        text = str(reason)
        raise BagError(text if text.startswith(str(bag)) else f'{bag}: {text}') from reason


def swept_of_samples(samples: Iterable[Sample], gear: GearRecord) -> tuple[SweptValue, ...]:
    """Compute the same from samples of instruments; see `swept`."""
    series = _series(samples)
    for name, other in (('port_length', ''), ('door_spread', ''), ('speed', 'ground_east')):
        if name not in series and other not in series:
            raise BagError(
                f'no readings on {CHANNELS[name].topic}, expected them for swept areas; '
                '`trawl bag check` lists what a bag lacks'
            )
    edges = _fishing(series)
    on = {name: _means(edges, *pair) for name, pair in series.items()}
    parts = np.ones(len(edges) - 1)
    step, mean = Factor(parts * (edges[1] - edges[0]), 0.0), Factor(parts / len(parts), 0.0)
    ground, water = _speeds(on, series, edges)
    seen = _modelled(gear, on, water.values)
    spread = _measured('door_spread', on, series, edges)
    width = Factor(
        seen.horizontal_opening / seen.door_spread * spread.values,
        math.hypot(spread.share, OPTIONS.width_half),
        'width of the mouth over spread modelled',
    )
    if 'vertical_opening' in on:
        height = _measured('vertical_opening', on, series, edges)
    else:
        height = Factor(
            parts * seen.vertical_opening, OPTIONS.height_half, 'height of the mouth modelled'
        )
    return (
        _product('distance over ground', 'm', ground, step),
        _product('distance through water', 'm', water, step),
        _product('door spread, mean', 'm', spread, mean),
        _product('width of the mouth, mean', 'm', width, mean),
        _product('height of the mouth, mean', 'm', height, mean),
        _product('area between the doors', 'm²', spread, ground, step),
        _product('area of the net', 'm²', width, ground, step),
        _product('volume of the net', 'm³', width, height, water, step),
    )


@dataclass(frozen=True)
class Factor:
    """Factor of a product over the haul.

    Attributes
    ----------
    values : (n,) array
        Means over equal parts of the haul.
    share
        What 95 % of the errors of all of them together stay within, over their mean.
    source
        What of it was not measured; '' if all was.
    """

    values: FloatArray
    share: float
    source: str = ''


def _measured(name: str, on: Mapping[str, FloatArray], series: Series, edges: FloatArray) -> Factor:
    half = OPTIONS.sensor_stds * _std(name, series, edges)
    return Factor(on[name], half / float(on[name].mean()))


def _product(name: str, unit: str, *factors: Factor) -> SweptValue:
    """Return the sum over the haul of a product of factors with independent errors."""
    value = float(np.prod([one.values for one in factors], axis=0).sum())
    source = '; '.join(filter(None, (one.source for one in factors))) or 'measured'
    return SweptValue(
        name, value, value * math.hypot(*(one.share for one in factors)), unit, source
    )


def _speeds(
    on: Mapping[str, FloatArray], series: Series, edges: FloatArray
) -> tuple[Factor, Factor]:
    """Return the speeds over ground and through the water; one stands in for the other."""
    ground = water = None
    if 'ground_east' in on:
        speed = np.hypot(on['ground_east'], on['ground_north'])
        error = max(_std(name, series, edges) for name in ('ground_east', 'ground_north'))
        ground = Factor(speed, OPTIONS.sensor_stds * error / float(speed.mean()))
    if 'speed' in on:
        water = _measured('speed', on, series, edges)
    known = ground or water
    assert known is not None
    return (
        ground or replace(known, source='speed over ground taken from that through the water'),
        water or replace(known, source='speed through the water taken from that over ground'),
    )


def _series(samples: Iterable[Sample]) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return times (s) and values of the used channels, without outliers."""
    pairs: defaultdict[str, list[tuple[float, float]]] = defaultdict(list)
    for sample in samples:
        for one in readings(sample, float):
            channel = CHANNELS[one.channel]
            inside = max(channel.low, one.low) <= one.value <= min(channel.high, one.high)
            if one.channel in USED and inside:
                pairs[one.channel].append((1e-9 * one.stamp, one.value))
    return {name: _cleaned(np.array(sorted(found)).T) for name, found in pairs.items()}


def _cleaned(pair: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Leave out readings far from the median of their neighbours (Hampel's rule)."""
    times, values = pair
    near = OPTIONS.neighbours
    padded = np.pad(values, near, mode='reflect' if len(values) > near else 'edge')
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * near + 1)
    middle = np.median(windows, axis=1)
    scatter = 1.4826 * np.median(np.abs(windows - middle[:, None]), axis=1)
    # Rounded readings may not scatter at all.
    floor = max(float(np.median(scatter)), 1e-3 * abs(float(np.median(values))))
    kept = np.abs(values - middle) <= OPTIONS.outlier_limit * np.maximum(scatter, floor)
    return times[kept], values[kept]


def _fishing(series: Series) -> FloatArray:
    """Return the edges (s) of equal parts of the haul."""
    times, lengths = series['port_length']
    out = times[lengths >= OPTIONS.fishing_fraction * lengths.max()]
    if out[-1] - out[0] < 10.0 * OPTIONS.step_s:
        raise BagError(f'the warps are out for {out[-1] - out[0]:.0f} s; expected a longer haul')
    return np.linspace(out[0], out[-1], 1 + round((out[-1] - out[0]) / OPTIONS.step_s))


def _means(edges: FloatArray, times: FloatArray, values: FloatArray) -> FloatArray:
    """Return the means of a channel between edges (s), in which each reading counts.

    Values between two of them would count only the nearest readings, and leave more of their noise.
    """
    times = np.array([min(edges[0], times[0]), *times, max(edges[-1], times[-1])])
    values = np.array([values[0], *values, values[-1]])
    integral = np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(times)))
    means: FloatArray = np.diff(np.interp(edges, times, integral)) / np.diff(edges)
    return means


def _std(name: str, series: Series, edges: FloatArray) -> float:
    """Return the standard deviation of a channel's mean: of its calibration and its noise."""
    read, values = series[name]
    inside = values[(read >= edges[0]) & (read <= edges[-1])]
    if len(inside) < 3:
        raise BagError(f'{len(inside)} readings on {CHANNELS[name].topic}, expected 3 or more')
    noise = float(np.std(np.diff(inside))) / math.sqrt(2 * len(inside))
    return math.hypot(noise, CHANNELS[name].steady_std(float(inside.mean())))


def _modelled(gear: GearRecord, on: Mapping[str, FloatArray], water: FloatArray) -> Observables:
    """Return the state of the model at the mean of the haul."""
    warps = [on[name].mean() for name in ('port_length', 'starboard_length') if name in on]
    try:
        model = build_model(gear)
        return steady_state(model, float(np.mean(warps)), float(water.mean())).observables
    except NoSteadyState as refusal:
        raise NoSteadyState(
            f'the mean of the haul has no steady state, expected one for the width of the mouth: '
            f'{refusal}',
            refusal.reason,
            refusal.remedy,
        ) from refusal
