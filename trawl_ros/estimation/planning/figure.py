# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a plan: its steady states, and the predicted std of the laws' quantities."""

from collections import Counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.estimation.fit.laws import LAWS, WELL_KNOWN, LawQuantities
from trawl_ros.estimation.planning.plan import TrialPlan
from trawl_ros.report.style import FAINT, MEASURED, SECOND, quiet

PLAN_COLOUR, SWEEP_COLOUR, PRIOR_COLOUR = MEASURED, SECOND, FAINT
PAPER_CHANNELS_COLOUR = '#8c564b'
SPREAD_COLOUR = '#e3e6e8'
"""Colour of the line from the smallest to the largest std of a quantity."""

MARKER_SHIFT_M_S = 0.016
"""Shift of markers along the speed axis that keeps equal and unequal warps apart, m/s."""

MARKER_AREA_PER_VISIT = 70.0
"""Area of a marker for each visit to a state, pt²."""


def plan_figure(plan: TrialPlan) -> Figure:
    """Draw the plan.

    The left panel shows the steady states over warp length and speed. The right panel shows std
    over span of the twelve quantities, before and after the plan and the paper's sweep.
    """
    figure = Figure(figsize=(13.0, 5.6), layout='constrained')
    states, quantities = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    _draw_states(states, plan)
    _draw_quantities(quantities, plan)
    figure.suptitle(
        f'A trial of {plan.trial.minutes / 60.0:.1f} h for {plan.gear}: '
        f'{len(plan.trial.legs)} steady states, {plan.trial.known.well_known.sum()} of '
        f'{len(plan.trial.known.sd)} quantities well known'
    )
    return figure


def _draw_states(axes: Axes, plan: TrialPlan) -> None:
    """Draw the planned, the unused and the impossible states, and the paper's sweep."""
    visits = Counter(plan.trial.manoeuvres)
    for equal, mark, label in (
        (True, 'o', 'warps equal'),
        (False, '^', 'port warp shorter'),
    ):
        chosen = {
            manoeuvre: number for manoeuvre, number in visits.items() if manoeuvre.equal == equal
        }
        axes.scatter(
            [manoeuvre.length for manoeuvre in chosen],
            # Many states with equal and unequal warps have the same mean length and speed.
            [
                manoeuvre.speed + (MARKER_SHIFT_M_S if equal else -MARKER_SHIFT_M_S)
                for manoeuvre in chosen
            ],
            s=[MARKER_AREA_PER_VISIT * number for number in chosen.values()],
            marker=mark,
            color=PLAN_COLOUR if equal else SECOND,
            label=label,
            zorder=3,
        )
    unused = {candidate.manoeuvre for candidate in plan.choice.candidates} - visits.keys()
    _draw_crosses(
        axes,
        [(manoeuvre.length, manoeuvre.speed) for manoeuvre in unused if manoeuvre.equal],
        '+',
        'not needed',
    )
    refused = {state.manoeuvre for state in plan.choice.refused}
    _draw_crosses(
        axes,
        [(manoeuvre.length, manoeuvre.speed) for manoeuvre in refused if manoeuvre.equal],
        'x',
        'cannot be towed',
    )
    sweep = plan.sweeps[0].manoeuvres
    if sweep:
        axes.plot(
            [manoeuvre.length for manoeuvre in sweep],
            [manoeuvre.speed for manoeuvre in sweep],
            color=FAINT,
            label="the paper's sweep",
            zorder=1,
        )
    axes.set_xlabel('warp length / m')
    axes.set_ylabel('speed / (m/s)')
    axes.set_title('Planned states (large: visited twice)', fontsize='medium')
    axes.margins(0.08)
    quiet(axes)
    axes.legend(fontsize='small', loc='upper center', bbox_to_anchor=(0.5, -0.12), ncols=3)


def _draw_crosses(axes: Axes, states: list[tuple[float, float]], mark: str, label: str) -> None:
    """Mark states, given as warp length (m) and speed (m/s)."""
    if states:
        axes.plot(*zip(*states, strict=True), mark, color=FAINT, label=label, zorder=2)


def _draw_quantities(axes: Axes, plan: TrialPlan) -> None:
    """Draw std over span of each quantity before the trial, and after the plan or the sweep."""
    names = [f'${law.symbol}$ {what}' for what in ('value', 'slope') for law in LAWS]
    # The quantities are all values, then all slopes. Put value and slope of a law together.
    order = np.arange(len(names)).reshape(2, -1).T.ravel()
    heights = np.arange(len(names))[::-1]
    # The axis is logarithmic; its lower limit is set below.
    axes.axvspan(1e-4, WELL_KNOWN, color=PLAN_COLOUR, alpha=0.08, lw=0, label='well known')
    rows: tuple[tuple[str, LawQuantities, str, str], ...] = (
        ('before', plan.before, '|', PRIOR_COLOUR),
        ("sweep, the paper's channels", plan.sweeps[1].known, 's', PAPER_CHANNELS_COLOUR),
        ('sweep, all channels', plan.sweeps[0].known, 'D', SWEEP_COLOUR),
        ('plan', plan.trial.known, 'o', PLAN_COLOUR),
    )
    if plan.in_motion is not None:
        rows = (*rows, ('plan, whole tow', plan.in_motion.whole, '*', PLAN_COLOUR))
    ratios = np.array([known.ratio for _, known, _, _ in rows])
    axes.hlines(heights, ratios.min(0)[order], ratios.max(0)[order], color=SPREAD_COLOUR, zorder=1)
    for (label, _, mark, colour), ratio in zip(rows, ratios, strict=True):
        axes.plot(ratio[order], heights, mark, color=colour, label=label, ms=6, mew=1.6)
    axes.set_xscale('log')
    axes.set_xlim(0.7 * ratios.min(), 1.4 * ratios.max())
    axes.set_yticks(heights, [names[i] for i in order])
    axes.set_xlabel('standard deviation / what the law spans over 15°')
    axes.set_title('What is known of the laws of eq. 14', fontsize='medium')
    quiet(axes)
    axes.legend(fontsize='small', loc='upper center', bbox_to_anchor=(0.5, -0.12), ncols=3)
