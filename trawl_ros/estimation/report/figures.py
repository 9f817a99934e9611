# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the identification report."""

from trawl_ros.estimation.report.figures_coefficients import (
    coefficients_figure,
    lift_drag_figure,
    spectrum_figure,
)
from trawl_ros.estimation.report.figures_course import convergence_figure, objective_figure
from trawl_ros.estimation.report.figures_fit import channels_figure, residuals_figure
from trawl_ros.estimation.report.figures_tows import held_out_figure, tow_biases_figure
from trawl_ros.estimation.report.report import Report
from trawl_ros.report.pictures import Drawing

FIT = 'How well it fits'
KNOWN = 'What the data know'
COURSE = 'How it got there'


def drawings(report: Report) -> list[Drawing]:
    """Return all figures for which the report has the numbers."""
    if not report.windows:
        return _known(report)
    if report.paired:
        return [*_fit(report), _objective(report)]
    course = [_objective(report), _convergence(report)]
    return [*_fit(report), *_known(report), *course]


def _fit(report: Report) -> list[Drawing]:
    return [
        Drawing(
            'held_out',
            'Error of each channel: at rest in the windows, fitted; and of what was left out of '
            'the fit. Dots are single tows; the line is the fit of the paper to its own points.',
            held_out_figure(report), FIT,
        ),
        Drawing(
            'channels',
            'Measured (dots) and modelled (lines) over warp length, one colour per speed. '
            'Dashed: before the fit.',
            channels_figure(report), FIT,
        ),
        Drawing(
            'residuals',
            'Measured less modelled over warp length and speed, in stated standard deviations. '
            'Shaded: where nineteen of twenty belong. What grows along an axis is missing from '
            'the model.',
            residuals_figure(report), FIT,
        ),
        Drawing(
            'tow_biases',
            'What the fit takes each instrument to read too high by, one standard deviation '
            'either way, in each tow. Shaded: what was known of it before.',
            tow_biases_figure(report), FIT,
        ),
    ]  # fmt: skip


def _known(report: Report) -> list[Drawing]:
    drawn = [
        Drawing(
            'coefficients',
            'Each coefficient by its departure from the start, in standard deviations of the '
            'prior. Open dots: not determined by the data.',
            coefficients_figure(report), KNOWN,
        ),
        Drawing(
            'spectrum',
            'Left: how well the data know each direction among the coefficients; below 1 the '
            'prior knew more. Right: which coefficients each direction is made of.',
            spectrum_figure(report), KNOWN,
        ),
    ]  # fmt: skip
    if report.law is not None:
        drawn.append(
            Drawing(
                'lift_drag',
                "Lift and drag of the board over the attack angle, as in the paper's Fig. 5, with "
                '95 % bands. Shaded: where the boards worked, where that is known.',
                lift_drag_figure(report), KNOWN,
            )
        )  # fmt: skip
    return drawn


def _objective(report: Report) -> Drawing:
    return Drawing(
        'objective',
        "Objective of eq. 35 over the iterations, as in the paper's Fig. 4. Windows are "
        'taken in as they come, so the start values are drawn for the same windows.',
        objective_figure(report),
        COURSE,
    )


def _convergence(report: Report) -> Drawing:
    return Drawing(
        'convergence',
        'Each coefficient with its 95 % interval after each window, and at rest. Grey: the '
        'prior. Dotted: the truth, where it is known. Upright lines: another tow begins.',
        convergence_figure(report),
        COURSE,
    )
