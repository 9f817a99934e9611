# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Outcome of fitting a whole tow, compared with the estimate of its steady windows."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.fit_records import MotionFit
from trawl_ros.estimation.motion.towing.records import LeftOut

POOR_MISFIT = 2.0
"""Root mean square of a stretch's whitened residuals from which it fits badly."""


@dataclass(frozen=True)
class PoorStretch:
    """Stretch that fits badly.

    Known are its tow, where it begins (s), and the root mean square of its whitened residuals.
    """

    tow: str
    begin: float
    size: float


@dataclass(frozen=True)
class MotionOutcome:
    """Outcome of a fit of whole tows.

    Attributes
    ----------
    fit
        The fit.
    prior, windows
        The prior, and the estimate of the steady windows; None where there is no window.
    refused
        A sentence for each bag, or part of one, that is not in the fit.
    held_out : (n, 4) array
        Steady windows in the channels of eq. 35, predicted by fits without the stretches of their
        state; NaN where there is no prediction.
    """

    fit: MotionFit
    prior: ParameterVector
    windows: Estimate | None
    refused: tuple[str, ...]
    held_out: FloatArray

    @cached_property
    def estimate(self) -> Estimate:
        """Estimate by the whole tow."""
        fit = self.fit
        ends = [linear.tow.start_ns + int(1e9 * linear.tow.middles[-1]) for linear in fit.linear]
        return Estimate(
            self.prior, 1, max(ends), 0, fit.values, fit.covariance,
            fit.cost, fit.converged, fit.reason, net=fit.net,
        )  # fmt: skip

    @property
    def ratio(self) -> FloatArray:
        """Ratio (q,) of the std of the whole tow to that of its windows or of the prior."""
        before = self.prior.std if self.windows is None else self.windows.std
        return np.asarray(self.estimate.std / before, np.float64)

    @property
    def geometric_means(self) -> dict[str, float]:
        """Geometric means over the coefficients of posterior over prior std.

        They are those of the ``windows`` and the ``whole``, and their ``ratio``; 1 for no windows.
        """
        return {
            'windows': 1.0 if self.windows is None else _mean(self.windows.std / self.prior.std),
            'whole': _mean(self.estimate.std / self.prior.std),
            'ratio': _mean(self.ratio),
        }

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tows."""
        return tuple(linear.tow.name for linear in self.fit.linear)

    @property
    def duration_s(self) -> float:
        """Time of all stretches that count."""
        return float(
            sum(
                linear.tow.stretch_s * np.isfinite(linear.residual).any(axis=1).sum()
                for linear in self.fit.linear
            )
        )

    @property
    def swells(self) -> tuple[tuple[str, float], ...]:
        """Swing of the tension, in std over its mean, in each tow that feels a swell.

        It is given with the name of the tow, or of a part of one.
        """
        tows = [linear.tow for linear in self.fit.linear]
        return tuple((tow.name, tow.swell) for tow in tows if tow.swell)

    @property
    def left_out(self) -> tuple[tuple[str, LeftOut], ...]:
        """Stretches that do not count, neighbours as one, with the name of their tow."""
        found = []
        for linear in self.fit.linear:
            merged: list[LeftOut] = []
            for part in (*linear.tow.left_out, *linear.left_out):
                if merged and merged[-1].why == part.why and part.begin <= merged[-1].end:
                    last = max(part.end, merged[-1].end)
                    merged[-1] = LeftOut(merged[-1].begin, last, part.why)
                else:
                    merged.append(part)
            found += [(linear.tow.name, part) for part in merged]
        return tuple(found)

    @property
    def spread(self) -> Mapping[str, float]:
        """Root mean square of each channel's whitened residuals: 1 where errors are as found."""
        squares: dict[str, list[float]] = {}
        for number, linear in enumerate(self.fit.linear):
            white = self._whitened(number)
            for column, name in enumerate(linear.tow.channels):
                own = white[:, column]
                squares.setdefault(name, []).extend((own[np.isfinite(own)] ** 2).tolist())
        return {name: float(np.sqrt(np.mean(own))) for name, own in squares.items() if own}

    @property
    def poor(self) -> tuple[PoorStretch, ...]:
        """Stretches that fit badly, the worst first."""
        found = []
        for number, linear in enumerate(self.fit.linear):
            white = self._whitened(number)
            for stretch in np.flatnonzero(np.isfinite(white).any(axis=1)):
                size = float(np.sqrt(np.nanmean(white[stretch] ** 2)))
                if size > POOR_MISFIT:
                    begin = stretch * linear.tow.stretch_s
                    found.append(PoorStretch(linear.tow.name, float(begin), size))
        return tuple(sorted(found, key=lambda each: -each.size))

    def _whitened(self, number: int) -> FloatArray:
        """Whitened residuals (n, k) of a tow at the estimate: innovations, in the order of time."""
        linear, z = self.fit.linear[number], self.fit.parameters[number]
        white = np.full(linear.values.shape, np.nan)
        for group, rows in enumerate(self.fit.data.tows[number]):
            if len(rows.residual):
                root = rows.root(self.fit.sizes.of_group(group), self.fit.data.times)
                away = rows.residual - rows.columns @ z
                place = rows.rows.stretches, rows.rows.channels
                white[place] = solve_triangular(root, away, lower=True)
        return white


def _mean(values: FloatArray) -> float:
    return float(np.exp(np.mean(np.log(values))))
