# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figures of the convergence of the estimate."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.objective import objective
from trawl_ros.estimation.report.report import Report
from trawl_ros.report.style import FAINT, MEASURED, MEASURED_TRUTH, PORT, SECOND, quiet


def objective_figure(report: Report) -> Figure:
    """The objective of eq. 35 over the iterations, as the paper's Fig. 4."""
    figure = Figure(figsize=(9.0, 4.5), layout='constrained')
    axes = figure.subplots()
    # The start values are iteration 0, over the windows that the first iteration had.
    windows = [entry.windows for entry in report.history]
    windows = [*windows[:1], *windows]
    steps = np.arange(len(windows))

    def over_same(values: FloatArray) -> list[float]:
        return [objective(values[:number], report.measured[:number]) for number in windows]

    before = over_same(report.at_start)

    axes.plot(steps, before, color=FAINT, ls='--', label='at the start values')
    if report.at_truth is not None:
        axes.plot(steps, over_same(report.at_truth), color=PORT, ls=':', label='at the truth')
    axes.plot(
        steps, [*before[:1], *(entry.objective for entry in report.history)], '.-', color=MEASURED,
        label='at the estimate',
    )  # fmt: skip
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel('iteration')
    axes.set_ylabel('objective, eq. 35')
    quiet(axes)
    twin = axes.twinx()
    twin.step(steps, windows, where='post', color=SECOND, alpha=0.5, lw=1.0)
    twin.set_ylabel('windows in the fit', color=SECOND)
    twin.set_ylim(bottom=0)
    twin.spines['top'].set_visible(False)
    figure.legend(loc='outside upper center', ncols=3, fontsize='small', frameon=False)
    return figure


def convergence_figure(report: Report) -> Figure:
    """Each coefficient with its interval after each window."""
    figure = Figure(figsize=(11.0, 7.5), layout='constrained')
    number = np.arange(1, len(report.course) + 1)
    estimates = [event.estimate for event in report.course]
    tow = np.array([event.window.tow for event in report.course])
    begins = number[1:][np.diff(tow) > 0] - 0.5
    names = report.estimate.names
    panels = figure.subplots(-(-len(names) // 4), 4, sharex=True)
    for i, (name, axes) in enumerate(zip(names, panels.flat, strict=False)):
        start, std = report.prior.start[i], report.prior.std[i]
        axes.axhspan(start - 2.0 * std, start + 2.0 * std, color=FAINT, alpha=0.2, lw=0)
        axes.fill_between(
            number,
            [estimate.low[i] for estimate in estimates],
            [estimate.high[i] for estimate in estimates],
            color=MEASURED,
            alpha=0.25,
            lw=0,
        )
        axes.plot(number, [estimate.values[i] for estimate in estimates], color=MEASURED)
        last = report.estimate
        axes.errorbar(
            number[-1] + 1, last.values[i],
            [[max(last.values[i] - last.low[i], 0.0)], [max(last.high[i] - last.values[i], 0.0)]],
            fmt='o', ms=4, color=MEASURED_TRUTH, capsize=2,
        )  # fmt: skip
        if report.truth is not None:
            axes.axhline(report.truth[i], color=PORT, ls=':', lw=1.5)
        for place in begins:
            axes.axvline(place, color=SECOND, lw=0.8)
        axes.set_title(name, fontsize='medium')
        quiet(axes)
    for axes in panels[-1]:
        axes.set_xlabel('windows')
    return figure
