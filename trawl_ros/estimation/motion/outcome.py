# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Outcome of fitting tows as chains of parts: the estimate, and what fits badly."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.error_terms import GROUPS, channel_errors
from trawl_ros.estimation.fit.estimate import (
    Estimate,
    Posterior,
    TowBias,
    posterior_of,
    undetermined,
)
from trawl_ros.estimation.fit.fitted_estimate import tow_biases
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.information import Information, extended_root, joined
from trawl_ros.estimation.motion.fit_records import MotionFit
from trawl_ros.estimation.motion.holdout import HeldOut
from trawl_ros.estimation.motion.towing.inputs import INPUT_ERRORS
from trawl_ros.estimation.motion.towing.records import LeftOut
from trawl_ros.records.channels import INPUTS

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
    """Outcome of a fit of tows as chains of parts.

    Attributes
    ----------
    fit
        The fit.
    prior
        Of the coefficients.
    numbers
        Of each tow in the fit, the number of the tow that it is a part of.
    refused
        A sentence for each bag, or part of one, that is not in the fit.
    held_out
        Steady stretches, predicted by fits without their tow or state.
    """

    fit: MotionFit
    prior: ParameterVector
    numbers: tuple[int, ...]
    refused: tuple[str, ...]
    held_out: HeldOut

    @property
    def steady_only(self) -> bool:
        """True if the steady parts alone were fitted."""
        return all(linear.tow.steady_only for linear in self.fit.linear)

    @property
    def what(self) -> str:
        """What was fitted, in words."""
        return 'the steady parts' if self.steady_only else 'the whole tow'

    @cached_property
    def posterior(self) -> Posterior:
        """Posterior of the coefficients, all other parameters integrated out."""
        matrix = self.fit.matrix
        every = Information(matrix, np.zeros(len(matrix)), 0.0, 0.0)
        own = joined([every], [np.ones(len(matrix))], len(self.prior))
        return posterior_of(own.matrix, self.prior.std, 1.0)

    @cached_property
    def estimate(self) -> Estimate:
        """Estimate of the coefficients."""
        fit = self.fit
        ends = [linear.tow.start_ns + int(1e9 * linear.tow.middles[-1]) for linear in fit.linear]
        return Estimate(
            prior=self.prior,
            revision=1,
            stamp=max(ends),
            windows=0,
            values=fit.values,
            covariance=fit.covariance,
            cost=fit.cost,
            converged=fit.converged,
            reason=fit.reason,
            condition_number=self.posterior.condition_number,
            undetermined=undetermined(self.posterior, self.prior.names),
            noise_scales=dict(zip(GROUPS, fit.sizes.noise, strict=True)),
            net=fit.net,
        )

    @cached_property
    def tow_biases(self) -> tuple[TowBias, ...]:
        """Calibration errors of each tow's instruments, those of its inputs included."""
        fit, found = self.fit, []
        shared = extended_root(fit.matrix, np.ones(len(fit.matrix)), self.posterior.root)
        tows = zip(
            fit.linear, fit.layouts, fit.parameters, fit.data.information(fit.sizes),
            fit.data.precisions(fit.sizes.log), strict=True,
        )  # fmt: skip
        for number, (linear, layout, z, known, precision) in enumerate(tows):
            root = extended_root(known.matrix, precision, shared)
            means = dict(zip(INPUTS, linear.tow.inputs.values.mean(axis=0), strict=True))
            for name, column in zip(linear.tow.channels, linear.tow.means.T, strict=True):
                # An opening counts in steady parts only, and may have none.
                if np.isfinite(column).any():
                    means[name] = np.nanmean(column)
            tow = self.numbers[number]
            for part, terms in (
                ('calibration', channel_errors(layout.channels)),
                ('errors', INPUT_ERRORS),
            ):
                own = layout.slices[part]
                found += tow_biases(tow, terms, z[own], root[own], means)
        return tuple(found)

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
