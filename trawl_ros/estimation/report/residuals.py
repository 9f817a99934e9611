# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Residuals of each channel, window by window, and their statistics."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.estimation.fit.fitted_estimate import GATE
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.whiteness import Whiteness, ljung_box
from trawl_ros.estimation.pipeline import WindowUsed
from trawl_ros.records.channels import CHANNELS, INPUTS, MEASURED


@dataclass(frozen=True)
class ChannelResiduals:
    """Residuals of one channel, measured minus modelled, in order of time.

    Attributes
    ----------
    channel, unit
        Name of the channel, and the SI unit of ``values`` and ``stds``.
    windows, tows : (n,) int arrays
        Indices into the report's windows, and the tows they belong to.
    values, stds : (n,) arrays
        Residuals, and the standard deviations stated for them: of the reading, its
        calibration, and what errors of warp lengths and speed do to the prediction.
    """

    channel: str
    unit: str
    windows: IntArray
    tows: IntArray
    values: FloatArray
    stds: FloatArray

    @property
    def scaled(self) -> FloatArray:
        """Normalised residuals (n,), over their stated std."""
        return self.values / self.stds

    @property
    def mean(self) -> float:
        """Mean residual."""
        return float(self.values.mean())

    @property
    def std(self) -> float:
        """Standard deviation of the residuals about their mean; NaN for a single one."""
        return float(self.values.std(ddof=1)) if len(self.values) > 1 else float('nan')

    @property
    def stated_std(self) -> float:
        """Root mean square of the stated std."""
        return float(np.sqrt(np.mean(self.stds**2)))

    @property
    def test_ratio(self) -> float:
        """Mean of residual² over (3 std)²: 0.11 where errors are as stated, above 1 beyond."""
        return float(np.mean((self.scaled / GATE) ** 2))

    @property
    def whiteness(self) -> Whiteness | None:
        """Ljung–Box test of the residuals; None with too few of them."""
        return ljung_box([self.scaled[self.tows == tow] for tow in np.unique(self.tows)])


def residuals(linearised: Sequence[Linearised | None]) -> tuple[ChannelResiduals, ...]:
    """Collect the residuals of each channel that any of the windows has.

    Parameters
    ----------
    linearised
        From `Estimator.solve`, at the estimate.
    """
    rows: dict[str, list[tuple[int, int, float, float]]] = {}
    for i, linear in enumerate(linearised):
        if linear is None:
            continue
        window = linear.window
        input_std = np.array([window.std(name) for name in INPUTS])
        std = np.hypot(
            [window.std(name) for name in linear.channels],
            np.linalg.norm(linear.by_inputs * input_std, axis=1),
        )
        left = linear.measured - linear.solved
        for name, value, size in zip(linear.channels, left, std, strict=True):
            rows.setdefault(name, []).append((i, window.tow, float(value), float(size)))
    return _gathered(rows)


def innovations(course: Sequence[WindowUsed]) -> tuple[ChannelResiduals, ...]:
    """Collect the innovations: readings minus their predictions before each window was used.

    Parameters
    ----------
    course
        The windows, each with the estimate after it.
    """
    rows: dict[str, list[tuple[int, int, float, float]]] = {}
    for i, event in enumerate(course):
        innovation = event.estimate.innovation
        if innovation is None:
            continue
        for name, value, std in zip(
            innovation.channels, innovation.values, innovation.stds, strict=True
        ):
            rows.setdefault(name, []).append((i, event.window.tow, float(value), float(std)))
    return _gathered(rows)


def _gathered(rows: dict[str, list[tuple[int, int, float, float]]]) -> tuple[ChannelResiduals, ...]:
    gathered = []
    for name in MEASURED:
        if name in rows:
            windows, tows, values, stds = (np.array(column) for column in zip(*rows[name]))
            unit = CHANNELS[name].unit
            gathered.append(ChannelResiduals(name, unit, windows, tows, values, stds))
    return tuple(gathered)
