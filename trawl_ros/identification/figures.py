"""The report as figures."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import norm

from trawl_ros.identification.objective import PAPER_CHANNELS
from trawl_ros.identification.report import Report
from trawl_ros.model.board import COEFFICIENTS

START, END, TRUTH, MEASURED = '#999999', '#1f77b4', '#2ca02c', '#000000'
ATTACK_DEG = np.linspace(0.0, 40.0, 81)
SHADED = float(norm.ppf(0.975))


def draw_figures(report: Report, folder: Path) -> list[Path]:
    """Draw all figures into an existing folder; return the files."""
    figures = {
        'coefficients.png': coefficients_figure(report),
        'channels.png': channels_figure(report),
        'objective.png': objective_figure(report),
        'lift_drag.png': lift_drag_figure(report),
    }
    paths = []
    for name, figure in figures.items():
        figure.savefig(folder / name, dpi=130)
        paths.append(folder / name)
    return paths


def coefficients_figure(report: Report) -> Figure:
    """Start, estimate with its interval and truth per coefficient, in units of prior std."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    estimate, prior = report.estimate, report.prior
    place = np.arange(len(COEFFICIENTS))

    def scaled(values: np.ndarray) -> np.ndarray:
        return (values - prior.start) / prior.std

    axes.axhspan(-1.0, 1.0, color=START, alpha=0.15, lw=0, label='prior ± 1 std')
    axes.plot(place, np.zeros(len(place)), 's', color=START, label='start')
    middle = scaled(estimate.values)
    arms = np.vstack((middle - scaled(estimate.low), scaled(estimate.high) - middle))
    axes.errorbar(
        place, middle, np.maximum(arms, 0.0), fmt='o', color=END, capsize=4,
        label='estimate, 95 % interval',
    )  # fmt: skip
    open_marks = [i for i in place if not estimate.determined[i]]
    axes.plot(
        open_marks, middle[open_marks], 'o', color='white', mec=END, ms=6, zorder=5,
        label='not determined by the data',
    )  # fmt: skip
    if report.truth is not None:
        axes.plot(place, scaled(report.truth), 'D', mfc='none', color=TRUTH, label='truth')
    axes.set_xticks(place, COEFFICIENTS)
    axes.set_ylabel('departure from the start / prior std')
    axes.set_title(f'Board coefficients after {estimate.windows} steady windows')
    axes.grid(axis='y', alpha=0.3)
    axes.legend(fontsize='small')
    return figure


def channels_figure(report: Report) -> Figure:
    """Measured and predicted against warp length, before and after, one panel per channel."""
    figure = Figure(figsize=(10.0, 7.5), layout='constrained')
    length = report.inputs[:, :2].mean(axis=1)
    errors = report.errors
    for i, (axes, channel) in enumerate(
        zip(figure.subplots(2, 2).flat, PAPER_CHANNELS, strict=True)
    ):
        scale, unit = (1e-3, 'kN') if channel.unit == 'N' else (1.0, channel.unit)
        axes.plot(length, scale * report.measured[:, i], 'o', color=MEASURED, label='measured')
        for values, key, mark, colour, label in (
            (report.at_start, 'start', 'x', START, 'before'),
            (report.at_end, 'end', '+', END, 'after'),
        ):
            axes.plot(
                length, scale * values[:, i], mark, color=colour, ms=9, mew=1.8,
                label=f'{label}, error {100.0 * errors[key][i]:.1f} %',
            )  # fmt: skip
        axes.set_xlabel('warp length / m')
        axes.set_ylabel(f'{channel.name.replace("_", " ")} / {unit}')
        if channel.name.endswith('depth'):
            axes.invert_yaxis()
        axes.grid(alpha=0.3)
        axes.legend(fontsize='small')
    return figure


def objective_figure(report: Report) -> Figure:
    """The objective of eq. 35 over the steps of the iteration, and the windows in it."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    steps = np.arange(1, len(report.history) + 1)
    axes.plot(steps, [entry.objective for entry in report.history], '.-', color=END)
    for key, colour in (('start', START), ('truth', TRUTH)):
        if key in report.objectives:
            axes.axhline(report.objectives[key], color=colour, ls='--', label=f'at the {key}')
    axes.set_yscale('log')
    axes.set_xlabel('step')
    axes.set_ylabel('objective, eq. 35')
    axes.grid(alpha=0.3, which='both')
    twin = axes.twinx()
    twin.step(steps, [entry.windows for entry in report.history], color=MEASURED, alpha=0.35)
    twin.set_ylabel('windows in the fit')
    twin.set_ylim(bottom=0)
    axes.legend(fontsize='small', loc='center right')
    return figure


def lift_drag_figure(report: Report) -> Figure:
    """Drag and lift coefficient of the board over the attack angle, as the paper's Fig. 5."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    drag, lift = figure.subplots(1, 2, sharex=True)
    _draw_line(drag, report, 'a1', 'c1')
    _draw_line(lift, report, 'a2', 'c2')
    drag.set_ylabel('drag coefficient $C_x^F$')
    lift.set_ylabel('lift coefficient $C_y^F$')
    return figure


def _draw_line(axes: Axes, report: Report, slope: str, constant: str) -> None:
    """One line a α + c of eq. 14 at start, estimate (with its 95 % band) and truth."""
    pair = [COEFFICIENTS.index(slope), COEFFICIENTS.index(constant)]
    basis = np.column_stack((np.radians(ATTACK_DEG), np.ones(len(ATTACK_DEG))))
    covariance = report.estimate.covariance[np.ix_(pair, pair)]
    middle = basis @ report.estimate.values[pair]
    half = SHADED * np.sqrt(np.sum(basis @ covariance * basis, axis=1))
    axes.plot(ATTACK_DEG, basis @ report.prior.start[pair], '--', color=START, label='start')
    axes.plot(ATTACK_DEG, middle, color=END, label='estimate, 95 % band')
    axes.fill_between(ATTACK_DEG, middle - half, middle + half, color=END, alpha=0.2, lw=0)
    if report.truth is not None:
        axes.plot(ATTACK_DEG, basis @ report.truth[pair], ':', color=TRUTH, lw=2, label='truth')
    axes.set_xlabel('attack angle α / °')
    axes.grid(alpha=0.3)
    axes.legend(fontsize='small')
