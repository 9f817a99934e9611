# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Reproduction of Fig. 13 to 16: 6-DOF boards, boards as points, and the synthetic sample trial."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.lab.report.measured import MeasuredValue, within
from trawl_ros.lab.report.page import Findings, TextTable
from trawl_ros.lab.report.panes import panes
from trawl_ros.lab.validation.cases import ValidationCase
from trawl_ros.lab.validation.paper.comparison import Comparison, column, compare_trial
from trawl_ros.lab.validation.paper.trial import warp_length
from trawl_ros.report.pictures import Drawing

PANELS = (
    ('Fig. 13', 'door_spread', 'door spread [m]', 1.0),
    ('Fig. 14', 'door_depth', 'door depth [m]', 1.0),
    ('Fig. 15', 'net_depth', 'net depth [m]', 1.0),
    ('Fig. 16', 'warp_tension', 'warp tension [kN]', 1e-3),
)


def run(quick: bool) -> Findings:
    """Compare the two kinds of boards with the sample trial."""
    seen = compare_trial(quick)
    solved = np.isfinite(seen.trial_six).all(1) & np.isfinite(seen.trial_three).all(1)
    checks = (
        MeasuredValue(
            'states of the trial for which both kinds of boards have a steady state',
            float(solved.sum()),
            target=within(0.0, of=float(len(seen.windows))),
            key='windows',
        ),
        MeasuredValue(
            'warp lengths of the sweep at which both have one',
            float(np.isfinite(seen.six + seen.three).all(1).sum()),
            target=within(0.0, of=float(len(seen.lengths))),
            key='lengths',
        ),
    )
    text = (
        f'The point has the coefficients of eq. 37 at α {np.degrees(seen.attack):.1f}° and '
        f'β {np.degrees(seen.slip):.1f}°, the means of the 6-DOF boards over the sweep; its lift '
        'is level. The trial is the synthetic sample trial of this package, not that of the paper, '
        'whose readings are not printed; its plant is twice as fine as the model.'
    )
    caption = (
        f'Fig. 13 to 16 remade. Lines and full marks at {seen.speed:.2f} m/s; open marks are the '
        'states of the synthetic trial at other speeds.'
    )
    return Findings(
        checks,
        (
            Drawing('fig13_to_16', caption, _lines(seen)),
            Drawing(
                'all_states',
                'Every state of the synthetic trial, each predicted at its own warp length and '
                'speed; the dashed line is agreement.',
                _states(seen),
            ),
        ),
        (_table(seen),),
        text,
    )


def _lines(seen: Comparison) -> Figure:
    figure, every = panes(10.0, 7.5, 2, 2)
    lengths = np.array([warp_length(window) for window in seen.windows])
    others = [row for row in range(len(lengths)) if row not in seen.on_line]
    rows = list(seen.on_line)
    for axes, (name, channel, label, scale) in zip(every, PANELS, strict=True):
        one = column(channel)
        axes.plot(seen.lengths, scale * seen.six[:, one], color='C0', label='6-DOF')
        axes.plot(seen.lengths, scale * seen.three[:, one], color='C3', label='3-DOF')
        trial = scale * seen.trial[:, one]
        axes.plot(lengths[rows], trial[rows], 'k:o', ms=5, label='synthetic trial')
        axes.plot(
            lengths[others], trial[others], 'o', mfc='none', mec='0.6', ms=5,
            label='synthetic trial, other speeds',
        )  # fmt: skip
        axes.set_title(name, fontsize='medium')
        axes.set(xlabel='warp length [m]', ylabel=label)
        if channel.endswith('depth'):
            axes.invert_yaxis()
        axes.legend(fontsize='small')
    return figure


def _states(seen: Comparison) -> Figure:
    figure, every = panes(10.0, 7.5, 2, 2)
    for axes, (name, channel, label, scale) in zip(every, PANELS, strict=True):
        one = column(channel)
        trial = scale * seen.trial[:, one]
        span = np.array([trial.min(), trial.max()])
        axes.plot(span, span, '--', color='0.6')
        for values, style, kind in (
            (seen.trial_six, 'C0o', '6-DOF'),
            (seen.trial_three, 'C3x', '3-DOF'),
        ):
            error = seen.error(values, channel)
            axes.plot(trial, scale * values[:, one], style, label=f'{kind}, error {error:.1f} %')
        axes.set_title(name, fontsize='medium')
        axes.set(xlabel=f'measured {label}', ylabel=f'predicted {label}')
        axes.legend(fontsize='small')
    return figure


def _table(seen: Comparison) -> TextTable:
    rows = []
    for row in PAPER_CHANNELS:
        errors = [
            seen.error(values, row.name)
            for values in (seen.trial_six, seen.trial_three, seen.trial_leaning)
        ]
        rows.append((row.name.replace('_', ' '), *(f'{error:.1f} %' for error in errors)))
    lean = np.degrees(seen.lean)
    return TextTable(
        'Mean error over mean measured value, all states of the trial. The last column: points '
        f'whose lift is tipped up by {lean:.1f}°, the mean δ of the 6-DOF boards.',
        ('', '6-DOF', '3-DOF', '3-DOF, lift tipped up'),
        tuple(rows),
    )


CASE = ValidationCase(
    'degrees_of_freedom', '6-DOF and 3-DOF boards against the synthetic trial (Fig. 13 to 16)', run
)
