# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of the ship's track: track over ground, headings, and current."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.plots.records import Series, TowHistory
from trawl_ros.report import style

ARROWS = 9
"""Number of places along the track with arrows of heading and current."""

AVERAGED_S = 60.0
"""Time over which the current is averaged, since it is a difference of two noisy speeds."""

LEAST_CURRENT = 0.03
"""Smallest current, m/s, that stands out from the noise of log and GPS."""


def track_figure(tow: TowHistory) -> Figure | None:
    """Draw the ship's track from above, north up; None if the bag holds no position."""
    fixes = fixes_on_map(tow)
    if 'east' not in tow.truth and fixes is None:
        return None
    figure = Figure(figsize=(7.2, 7.2), layout='constrained')
    axes = figure.subplots()
    style.quiet(axes)
    if fixes is not None:
        axes.plot(*fixes[1:], '.', color=style.MEASURED, ms=3, alpha=0.5, label='fixes')
    if 'east' in tow.truth:
        times, east, north = (
            tow.truth['east'].times,
            tow.truth['east'].values,
            tow.truth['north'].values,
        )
        axes.plot(east, north, color=style.MEASURED_TRUTH, linewidth=1.1, label='truth')
    else:
        assert fixes is not None
        times, east, north = fixes
    axes.plot(east[0], north[0], 'o', color='#333333', label='start')
    axes.plot(east[-1], north[-1], 's', color='#333333', label='end')
    axes.set_aspect('equal', adjustable='box')
    _roomy(axes, east, north)
    _arrows(axes, tow, times, east, north)
    axes.set_xlabel('east / km')
    axes.set_ylabel('north / km')
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(lambda metres, _: f'{1e-3 * metres:g}')
    axes.set_title(f'{tow.name}: the ship over ground', parse_math=False)
    figure.legend(loc='outside lower center', ncols=6, frameon=False, fontsize='small')
    return figure


def fixes_on_map(tow: TowHistory) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Times (s), east and north (m) of the fixes on the map.

    A bag does not say where ``map`` is on Earth. The first valid fix is therefore placed where
    truth had it, or at the origin.
    """
    if 'latitude' not in tow.measured:
        return None
    latitude, longitude = tow.measured['latitude'], tow.measured['longitude']
    known = np.isfinite(latitude.values) & np.isfinite(longitude.values)
    if not known.any():
        return None
    times = latitude.times[known]
    lat, lon = latitude.values[known], longitude.values[known]
    east, north = to_east_north(lat, lon, Datum(float(lat[0]), float(lon[0])))
    first = [
        tow.truth[name].at(float(times[0])) if name in tow.truth else 0.0
        for name in ('east', 'north')
    ]
    origin = np.where(np.isfinite(first), first, 0.0)
    return times, east + origin[0], north + origin[1]


def current(tow: TowHistory) -> tuple[Series, Series] | None:
    """Current to east and north (m/s): velocity over ground minus that through the water.

    It is from truth, or else from log, GPS and compass; None if one of them is missing.
    """
    names = ('ground_east', 'ground_north', 'speed_water', 'drift_water', 'heading')
    for quantities in (tow.truth, tow.measured):
        if all(name in quantities for name in names):
            times = quantities['ground_east'].times
            water_speed, drift, heading = (
                np.interp(times, *_known(quantities[name]), left=np.nan, right=np.nan)
                for name in names[2:]
            )
            c, s = np.cos(heading), np.sin(heading)
            return (
                Series(times, quantities['ground_east'].values - (c * water_speed - s * drift)),
                Series(times, quantities['ground_north'].values - (s * water_speed + c * drift)),
            )
    return None


def _known(series: Series) -> tuple[FloatArray, FloatArray]:
    known = np.isfinite(series.values)
    if not known.any():
        return np.array([0.0]), np.array([np.nan])
    return series.times[known], series.values[known]


def _mean(series: Series, time: float) -> float:
    near = np.abs(series.times - time) <= 0.5 * AVERAGED_S
    values = series.values[near & np.isfinite(series.values)]
    return float(values.mean()) if len(values) else float('nan')


def _roomy(axes: Axes, east: FloatArray, north: FloatArray) -> None:
    size = max(float(np.nanmax(east) - np.nanmin(east)), float(np.nanmax(north) - np.nanmin(north)))
    room = 0.7 * max(size, 20.0)
    for middle, limit in ((east, axes.set_xlim), (north, axes.set_ylim)):
        centre = 0.5 * (np.nanmin(middle) + np.nanmax(middle))
        limit(centre - room, centre + room)


def _arrows(
    axes: Axes, tow: TowHistory, times: FloatArray, east: FloatArray, north: FloatArray
) -> None:
    moments = np.linspace(times[0], times[-1], ARROWS)
    places = np.interp(moments, times, east), np.interp(moments, times, north)
    heading = tow.best('heading')
    if heading is not None:
        yaw = np.array([heading.at(float(moment)) for moment in moments])
        axes.quiver(
            *places, np.cos(yaw), np.sin(yaw), color='#444444', width=0.004, scale=16.0,
            zorder=4, label='heading',
        )  # fmt: skip
    currents = current(tow)
    if currents is None:
        return
    flow = np.array([[_mean(series, float(moment)) for moment in moments] for series in currents])
    speed = np.hypot(*flow)
    if not np.isfinite(speed).any():
        return
    mean = np.nanmean(flow, axis=1)
    if np.hypot(*mean) < LEAST_CURRENT:
        return
    axes.quiver(
        *places, *flow, color=style.SECOND, width=0.004, scale=float(12.0 * np.nanmax(speed)),
        zorder=5, label=_words(mean),
    )  # fmt: skip


def _words(mean: FloatArray) -> str:
    towards = float(np.degrees(np.arctan2(mean[0], mean[1])) % 360.0)
    return f'current, in the mean {np.hypot(*mean):.2f} m/s towards {towards:03.0f}°'
