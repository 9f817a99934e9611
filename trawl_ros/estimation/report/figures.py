"""Figures of the identification report."""

from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.core.files import write_figure
from trawl_ros.estimation.report.figures_coefficients import (
    coefficients_figure,
    lift_drag_figure,
    spectrum_figure,
)
from trawl_ros.estimation.report.figures_course import convergence_figure, objective_figure
from trawl_ros.estimation.report.figures_fit import channels_figure, residuals_figure
from trawl_ros.estimation.report.figures_tows import held_out_figure, tow_biases_figure
from trawl_ros.estimation.report.report import Report
from trawl_ros.report.style import DPI

FIT = 'How well it fits'
KNOWN = 'What the data know'
COURSE = 'How it got there'


@dataclass(frozen=True)
class ReportFigure:
    """Drawing: a figure, its file, the heading it stands under and its caption."""

    file: str
    section: str
    caption: str
    figure: Figure


def drawings(report: Report) -> list[ReportFigure]:
    """Return all figures for which the report has the numbers."""
    return [
        ReportFigure(
            'held_out.png', FIT,
            'Error of each channel: fitted, and predicted for what was left out of the fit. '
            'Dots are single tows; the line is what the paper has on the points it fitted.',
            held_out_figure(report),
        ),
        ReportFigure(
            'channels.png', FIT,
            'Measured (dots) and modelled (lines) over warp length, one colour per speed. '
            'Dashed: before the fit.',
            channels_figure(report),
        ),
        ReportFigure(
            'residuals.png', FIT,
            'Measured less modelled over warp length and speed, in stated standard deviations. '
            'Shaded: where nineteen of twenty belong. What grows along an axis is missing from '
            'the model.',
            residuals_figure(report),
        ),
        ReportFigure(
            'tow_biases.png', FIT,
            'What the fit takes each instrument to read too high by, one standard deviation '
            'either way, in each tow. Shaded: what was known of it before.',
            tow_biases_figure(report),
        ),
        ReportFigure(
            'coefficients.png', KNOWN,
            'Each coefficient by its departure from the start, in standard deviations of the '
            'prior. Open dots: not determined by the data.',
            coefficients_figure(report),
        ),
        ReportFigure(
            'spectrum.png', KNOWN,
            'Left: how well the data know each direction among the coefficients; below 1 the '
            'prior knew more. Right: which coefficients each direction is made of.',
            spectrum_figure(report),
        ),
        ReportFigure(
            'lift_drag.png', KNOWN,
            "Lift and drag of the board over the attack angle, as in the paper's Fig. 5, with "
            '95 % bands. Shaded: where the boards worked, where that is known.',
            lift_drag_figure(report),
        ),
        ReportFigure(
            'objective.png', COURSE,
            "Objective of eq. 35 over the iterations, as in the paper's Fig. 4. Windows are "
            'taken in as they come, so the start values are drawn for the same windows.',
            objective_figure(report),
        ),
        ReportFigure(
            'convergence.png', COURSE,
            'Each coefficient with its 95 % interval after each window, and at rest. Grey: the '
            'prior. Dotted: the truth, where it is known. Upright lines: another tow begins.',
            convergence_figure(report),
        ),
    ]  # fmt: skip


def draw_figures(report: Report, folder: Path) -> list[ReportFigure]:
    """Draw all figures into an existing folder."""
    found = drawings(report)
    for drawing in found:
        write_figure(folder / drawing.file, drawing.figure, DPI)
    return found
