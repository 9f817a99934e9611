# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the coefficients and their posterior."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtri

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.report.report import Report
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.report.style import FAINT, MEASURED, MEASURED_TRUTH, PORT, quiet

ATTACK_DEG = np.linspace(0.0, 40.0, 81)
SHADED = float(ndtri(0.975))
LEAST_SHOWN = 1e-3
"""A direction that the data know less than this of is drawn here."""


def coefficients_figure(report: Report) -> Figure:
    """Prior, estimate with its interval and truth per coefficient, in units of prior std."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    estimate, prior = report.estimate, report.prior
    place = np.arange(len(COEFFICIENTS))

    def scaled(values: FloatArray) -> FloatArray:
        return (values - prior.start) / prior.std

    label = 'prior, 95 %' if report.prior_weight else 'prior, 95 %, which was not used'
    axes.axhspan(-SHADED, SHADED, color=FAINT, alpha=0.2, lw=0, label=label)
    axes.axhline(0.0, color=FAINT, lw=1.0)
    middle = scaled(estimate.values)
    arms = np.vstack((middle - scaled(estimate.low), scaled(estimate.high) - middle))
    axes.errorbar(
        place, middle, np.maximum(arms, 0.0), fmt='o', color=MEASURED, capsize=4,
        label='estimate, 95 % interval',
    )  # fmt: skip
    open_marks = [i for i in place if not estimate.determined[i]]
    axes.plot(
        open_marks, middle[open_marks], 'o', color='white', mec=MEASURED, ms=6, zorder=5,
        label='not determined by the data',
    )  # fmt: skip
    if report.truth is not None:
        axes.plot(
            place, scaled(report.truth), 'D', mfc='none', mew=1.5, color=PORT, zorder=6,
            label='truth',
        )  # fmt: skip
    axes.set_xticks(place, COEFFICIENTS)
    axes.set_ylabel('departure from the start / prior std')
    axes.set_title(f'Board coefficients after {estimate.windows} steady windows')
    quiet(axes)
    axes.legend(fontsize='small', loc='upper left', bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure


def lift_drag_figure(report: Report) -> Figure:
    """Lift and drag coefficient of the board over the attack angle, as the paper's Fig. 5."""
    figure = Figure(figsize=(9.0, 5.0), layout='constrained')
    axes = figure.subplots()
    for slope, constant, colour, name in (
        ('a2', 'c2', MEASURED, 'lift $C_l$'),
        ('a1', 'c1', PORT, 'drag $C_d$'),
    ):
        _draw_line(axes, report, (slope, constant), colour, name)
    if report.laws is not None:
        axes.axvspan(*np.degrees(report.laws.attack), color=FAINT, alpha=0.2, lw=0)
    axes.set_xlim(ATTACK_DEG[0], ATTACK_DEG[-1])
    axes.set_xlabel('attack angle α / °')
    axes.set_ylabel('coefficient')
    quiet(axes)
    axes.legend(fontsize='small')
    return figure


def _draw_line(axes: Axes, report: Report, names: tuple[str, str], colour: str, words: str) -> None:
    """One line a α + c of eq. 14 at start, estimate (with its 95 % band) and truth."""
    pair = [COEFFICIENTS.index(name) for name in names]
    basis = np.column_stack((np.radians(ATTACK_DEG), np.ones(len(ATTACK_DEG))))
    covariance = report.estimate.covariance[np.ix_(pair, pair)]
    middle = basis @ report.estimate.values[pair]
    half = SHADED * np.sqrt(np.sum(basis @ covariance * basis, axis=1))
    axes.plot(ATTACK_DEG, middle, color=colour, lw=2, label=f'{words}, estimate')
    axes.fill_between(ATTACK_DEG, middle - half, middle + half, color=colour, alpha=0.18, lw=0)
    axes.plot(
        ATTACK_DEG, basis @ report.prior.start[pair], '--', color=colour, lw=1,
        label=f'{words}, start',
    )  # fmt: skip
    if report.truth is not None:
        axes.plot(
            ATTACK_DEG, basis @ report.truth[pair], ':', color=MEASURED_TRUTH, lw=2,
            label=f'{words}, truth',
        )  # fmt: skip


def spectrum_figure(report: Report) -> Figure:
    """Singular values of the data's sensitivities, and the coefficients in their directions."""
    figure = Figure(figsize=(11.0, 5.0), layout='constrained')
    bars, made_of = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    spectrum = report.spectrum
    rows = np.arange(len(spectrum.singular))
    weak = spectrum.singular < 1.0
    shown = np.maximum(spectrum.singular, LEAST_SHOWN)
    bars.barh(
        rows, shown, left=0.0, color=[PORT if flag else MEASURED for flag in weak], height=0.6
    )
    bars.axvline(1.0, color=MEASURED_TRUTH, lw=1.0, ls='--')
    bars.set_xscale('log')
    bars.set_xlim(left=min(0.1, 0.5 * float(shown.min())))
    bars.set_yticks(rows, [spectrum.name(row) for row in range(len(rows))])
    bars.invert_yaxis()
    bars.set_xlabel("prior's std over what the data leave (singular value)")
    bars.set_title(
        f'{int(weak.sum())} of {len(rows)} known less than before, condition '
        f'{report.estimate.condition_number:.2g}',
        loc='left',
        fontsize='medium',
    )
    quiet(bars)
    image = made_of.imshow(spectrum.directions**2, cmap='Blues', vmin=0.0, vmax=1.0, aspect='auto')
    made_of.set_xticks(np.arange(len(COEFFICIENTS)), COEFFICIENTS)
    made_of.set_yticks(rows, [f'{value:.2g}' for value in spectrum.singular])
    for row in rows[weak]:
        made_of.get_yticklabels()[row].set_color(PORT)
        bars.get_yticklabels()[row].set_color(PORT)
    figure.colorbar(image, ax=made_of, label='share of the coefficient')
    return figure
