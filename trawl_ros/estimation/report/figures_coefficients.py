# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the coefficients and their posterior."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtri

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.report.report import Report
from trawl_ros.model.numerics import STEP
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
    place = np.arange(len(estimate.names))

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
    axes.set_xticks(place, estimate.names)
    axes.set_ylabel('departure from the start / prior std')
    axes.set_title(f'Board coefficients after {estimate.windows} steady windows')
    quiet(axes)
    axes.legend(fontsize='small', loc='upper left', bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure


def lift_drag_figure(report: Report) -> Figure:
    """Lift and drag coefficient of the board over the attack angle, as the paper's Fig. 5."""
    figure = Figure(figsize=(9.0, 5.0), layout='constrained')
    axes = figure.subplots()
    for place, colour, name in ((1, MEASURED, 'lift $C_l$'), (0, PORT, 'drag $C_d$')):
        _draw_curve(axes, report, place, colour, name)
    if report.laws is not None:
        axes.axvspan(*np.degrees(report.laws.attack), color=FAINT, alpha=0.2, lw=0)
    axes.set_xlim(ATTACK_DEG[0], ATTACK_DEG[-1])
    axes.set_xlabel('attack angle α / °')
    axes.set_ylabel('coefficient')
    quiet(axes)
    axes.legend(fontsize='small')
    return figure


def _draw_curve(axes: Axes, report: Report, place: int, colour: str, words: str) -> None:
    """Coefficient of the law at start, estimate (with its 95 % band) and truth."""
    law, values, covariance = report.law, report.estimate.values, report.estimate.covariance
    assert law is not None
    attack = np.radians(ATTACK_DEG)

    def curve(at: FloatArray) -> FloatArray:
        return law(at, attack, 0.0)[:, place]

    steps = values + 1j * STEP * np.eye(len(values))
    slopes = np.stack([curve(step) for step in steps], axis=1).imag / STEP
    middle, half = curve(values), SHADED * np.sqrt(np.sum(slopes @ covariance * slopes, axis=1))
    axes.plot(ATTACK_DEG, middle, color=colour, lw=2, label=f'{words}, estimate')
    axes.fill_between(ATTACK_DEG, middle - half, middle + half, color=colour, alpha=0.18, lw=0)
    start = curve(report.prior.start)
    axes.plot(ATTACK_DEG, start, '--', color=colour, lw=1, label=f'{words}, start')
    if report.truth is not None:
        truth = curve(report.truth)
        axes.plot(ATTACK_DEG, truth, ':', color=MEASURED_TRUTH, lw=2, label=f'{words}, truth')


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
    made_of.set_xticks(np.arange(len(spectrum.names)), spectrum.names)
    made_of.set_yticks(rows, [f'{value:.2g}' for value in spectrum.singular])
    for row in rows[weak]:
        made_of.get_yticklabels()[row].set_color(PORT)
        bars.get_yticklabels()[row].set_color(PORT)
    figure.colorbar(image, ax=made_of, label='share of the coefficient')
    return figure
