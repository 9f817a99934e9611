"""Figure of coverage and spread by coefficient, and hold-out errors beside their bound."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.coverage.rows import (
    COVERAGE,
    MOST_ERROR,
    SPREAD,
    coverage_rows,
    held_out_rows,
    spread_rows,
)
from studies.coverage.trial import EstimationTrial
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.report import style

WITHIN = '#dfeee3'


def trials_figure(
    coverage: Sequence[EstimationTrial], bound: Sequence[EstimationTrial], prior: ParameterVector
) -> Figure:
    """Draw the results with their targets, all with 95 % intervals."""
    figure = Figure(figsize=(9.0, 9.5), layout='constrained')
    covered, spread, errors = figure.subplots(3, 1)
    _draw_rows(covered, coverage_rows(coverage, '', asked=True)[1:], COVERAGE)
    covered.set_ylabel('truths inside their\n95 % interval, %')
    covered.axhline(95.0, color=style.FAINT, linewidth=0.8)
    covered.set_ylim(top=101.0)
    if bound:
        _draw_rows(spread, spread_rows(bound, prior)[-len(COEFFICIENTS) :], SPREAD)
    spread.set_ylabel('error over its bound')
    spread.axhline(1.0, color=style.FAINT, linewidth=0.8)
    _draw_errors(errors, coverage)
    for axes in (covered, spread, errors):
        style.quiet(axes)
    return figure


def _draw_rows(axes: Axes, rows: Sequence[MeasuredValue], asked: tuple[float, float]) -> None:
    at = np.arange(len(rows))
    values, low, high = (np.array([getattr(row, key) for row in rows])
                         for key in ('value', 'low', 'high'))  # fmt: skip
    axes.axhspan(*asked, color=WITHIN, zorder=0)
    below, above = np.maximum(values - low, 0.0), np.maximum(high - values, 0.0)
    axes.errorbar(at, values, (below, above), fmt='o', color=style.MEASURED, capsize=3)
    axes.set_xticks(at, COEFFICIENTS)


def _draw_errors(axes: Axes, trials: Sequence[EstimationTrial]) -> None:
    found = held_out_rows(trials)
    rows = found[::2]
    at = np.arange(len(rows))
    values, low, high = (np.array([getattr(row, key) for row in rows])
                         for key in ('value', 'low', 'high'))  # fmt: skip
    floors = values / np.array([row.value for row in found[1::2]])
    below, above = np.maximum(values - low, 0.0), np.maximum(high - values, 0.0)
    axes.bar(at - 0.2, values, 0.4, color=style.MEASURED, label='fitted model')
    axes.errorbar(at - 0.2, values, (below, above), fmt='none', color='0.2', capsize=3)
    axes.bar(at + 0.2, floors, 0.4, color=style.FAINT, label='perfect model')
    for place, channel in zip(at, PAPER_CHANNELS, strict=True):
        most = MOST_ERROR[channel.name]
        axes.plot((place - 0.45, place + 0.45), (most, most), color=style.SECOND, linewidth=1.5)
    axes.plot([], [], color=style.SECOND, label='asked for at most')
    axes.set_xticks(at, [channel.name.replace('_', ' ') for channel in PAPER_CHANNELS])
    axes.set_ylabel('error on tows left out, %')
    axes.legend(fontsize='small')
