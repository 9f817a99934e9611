# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Predicted windows of a manoeuvre."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.fit import Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.planning.states import DEPTHS, PLANNED, TowableManoeuvre
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.channels import CHANNELS, INPUTS

WINDOW_S = 60.0
"""Length (s) of the window for which `TABLE_NOISE` is."""

TABLE_NOISE: Mapping[str, float] = MappingProxyType(
    {
        name: CHANNELS[name].noise / max(1.0, CHANNELS[name].min_rate * WINDOW_S) ** 0.5
        for name in (*INPUTS, *PLANNED)
    }
)
"""Standard error of a window's mean where no data have shown it yet: the channel table's noise
at the lowest rate that the instrument may have."""


def imagined_windows(
    candidate: TowableManoeuvre,
    coefficients: FloatArray,
    *,
    state: int,
    number: int,
    tow: int = 0,
    noise: Mapping[str, float] = TABLE_NOISE,
    to_come: float = 0.0,
) -> tuple[Linearised, ...]:
    """Predict the windows in a steady state at the assumed coefficients.

    Parameters
    ----------
    candidate
        Manoeuvre with its steady state.
    coefficients
        Of the board, (q,), as they are believed to be.
    state, tow
        Numbers they get.
    number
        Number of windows.
    noise
        Standard error of each channel's mean; channels that are not in it are not heard.
    to_come
        By how much (m) depths are still to change.
    """
    linear = candidate.part
    rows = [row for row, name in enumerate(linear.channels) if name in noise]
    channels = tuple(linear.channels[row] for row in rows)
    measured = linear.predicted(coefficients)[rows]
    means = {name: linear.window.means[name] for name in INPUTS}
    means |= {name: float(value) for name, value in zip(channels, measured, strict=True)}
    bias = {name: CHANNELS[name].bias_std(value) for name, value in means.items()}
    counts = dict.fromkeys(means, 1)
    chosen = {name: noise[name] for name in means}
    left = {name: to_come for name in DEPTHS if name in means}
    return tuple(
        replace(
            linear,
            window=SteadyWindow(index, state, 0, 0, means, chosen, bias, counts, tow, to_come=left),
            channels=channels,
            measured=measured,
            values=linear.values[rows],
            by_coefficients=linear.by_coefficients[rows],
            by_inputs=linear.by_inputs[rows],
            by_net=linear.by_net[rows],
            slow=linear.slow[rows],
        )
        for index in range(number)
    )


def expected_windows(fit: Fit, candidate: TowableManoeuvre, number: int) -> tuple[Linearised, ...]:
    """Predicted windows of a manoeuvre in a fit's newest tow, at its noise."""
    newest = fit.windows[-1].window
    imagined = imagined_windows(
        candidate,
        fit.coefficients,
        state=1 + max(linear.window.state for linear in fit.windows),
        number=number,
        tow=newest.tow,
        noise=_noise_of(fit),
    )
    first = 1 + max(linear.window.index for linear in fit.windows)
    return tuple(
        replace(linear, window=replace(linear.window, index=first + index))
        for index, linear in enumerate(imagined)
    )


def _noise_of(fit: Fit) -> Mapping[str, float]:
    """Median standard error of each channel with readings, over the windows of the newest tow."""
    tow = fit.windows[-1].window.tow
    windows = [linear.window for linear in fit.windows if linear.window.tow == tow]
    heard = {*INPUTS, *(name for linear in fit.windows for name in linear.channels)}
    return {
        name: float(np.median([window.noise[name] for window in windows if name in window.noise]))
        for name in sorted(heard)
        if 2 * sum(name in window.noise for window in windows) >= len(windows)
    }
