# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reproduction of Fig. 4 and 5: the objective over the iterations, and lift and drag."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.refit import PaperRefit, refit_trial
from trawl_ros.lab.validation.paper.trial import trial_windows
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.report.pictures import Drawing

ATTACK = np.radians(np.linspace(0.0, 40.0, 81))


def run(quick: bool) -> Findings:
    """Fit the default gear to the sample trial."""
    windows = trial_windows(quick)
    fit = refit_trial(quick)
    checks = (
        MeasuredValue(
            'states of the trial in the fit',
            float(fit.estimate.windows),
            target=within(0.0, of=float(len(windows))),
            note='eq. 35 sums over 15 groups of data, this over the first window of each state',
            key='windows',
        ),
        MeasuredValue(
            'the fit converges',
            float(fit.estimate.converged),
            target=within(0.0, of=1.0),
            note=fit.estimate.reason,
            key='converged',
        ),
    )
    return Findings(
        checks,
        (
            Drawing(
                'fig4',
                'Fig. 4 remade: eq. 35 with λ = 1/(n · mean measured value). One iteration moves '
                'all twelve coefficients.',
                _objective(fit),
            ),
            Drawing(
                'fig5',
                'Fig. 5 remade, with two standard deviations of the estimate. In place of the '
                "tests of the paper's references 18 and 19, whose figures it does not print, "
                'stand the coefficients that made the synthetic trial. Shaded: where the '
                'boards worked.',
                _lines(fit),
            ),
        ),
        (_table(fit),),
    )


def _objective(fit: PaperRefit) -> Figure:
    figure, (axes,) = panes(7.5, 4.5)
    axes.plot(np.arange(len(fit.objective)), fit.objective, 'C0-o', ms=4, label='objective')
    axes.axhline(fit.objective[0] / 3.0, color='0.5', ls='--', label='a third of the first')
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel='iteration [-]', ylabel='objective of eq. 35 [-]')
    axes.legend()
    return figure


def _lines(fit: PaperRefit) -> Figure:
    figure, (axes,) = panes(7.5, 5.0)
    degrees = np.degrees(ATTACK)
    axes.axvspan(*np.degrees(fit.attack), color='0.92', lw=0)
    for slope, colour, name in (('a2', 'C0', 'lift $C_l$'), ('a1', 'C3', 'drag $C_d$')):
        line = fit.line(fit.estimate.values, slope, ATTACK)
        band = 2.0 * fit.half_width(slope, ATTACK)
        axes.plot(degrees, line, color=colour, label=f'{name}, estimated')
        axes.fill_between(degrees, line - band, line + band, color=colour, alpha=0.2, lw=0)
        axes.plot(
            degrees, fit.line(fit.truth, slope, ATTACK), ':', color=colour, lw=2,
            label=f'{name}, what made the trial',
        )  # fmt: skip
        axes.plot(
            degrees, fit.line(fit.prior.start, slope, ATTACK), '--', color=colour, lw=0.9,
            label=f'{name}, start',
        )  # fmt: skip
    axes.set(xlabel='attack angle α [°]', ylabel='coefficient [-]')
    axes.legend(fontsize='small')
    return figure


def _table(fit: PaperRefit) -> TextTable:
    estimate = fit.estimate
    rows = [
        (
            name,
            f'{fit.prior.start[i]:.3f}',
            f'{estimate.values[i]:.3f}',
            f'{estimate.low[i]:.3f} to {estimate.high[i]:.3f}',
            f'{fit.truth[i]:.3f}',
            'yes' if estimate.determined[i] else 'no',
        )
        for i, name in enumerate(COEFFICIENTS)
    ]
    head = ('', 'start', 'estimate', '95 % interval', 'made the trial', 'determined by the data')
    return TextTable('The coefficients of eq. 37.', head, tuple(rows))


CASE = ValidationCase(
    'identified', 'Coefficients refitted to the synthetic sample trial (Fig. 4 and 5)', run
)
