# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of a plan: its legs, and the std of the quantities after it."""

from collections import Counter

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trawl_ros.estimation.fit.laws import LAWS, WELL_KNOWN, LawQuantities
from trawl_ros.estimation.planning.plan import TrialPlan
from trawl_ros.report.style import FAINT, MEASURED, SECOND, quiet

PLAN, SWEEP, PAPER, BEFORE = MEASURED, SECOND, '#8c564b', FAINT


def plan_figure(plan: TrialPlan) -> Figure:
    """Draw legs over warp length and speed beside the std of the twelve quantities."""
    figure = Figure(figsize=(13.0, 5.6), layout='constrained')
    legs, known = figure.subplots(1, 2, width_ratios=(1.0, 1.25))
    _legs(legs, plan)
    _known(known, plan)
    figure.suptitle(
        f'A trial of {plan.trial.minutes / 60.0:.1f} h for {plan.gear}: '
        f'{len(plan.trial.legs)} steady states, {plan.trial.known.well_known.sum()} of '
        f'{len(plan.trial.known.sd)} quantities well known'
    )
    return figure


def _legs(axes: Axes, plan: TrialPlan) -> None:
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
            # Beside each other, since many have the same length and speed.
            [manoeuvre.speed + (0.016 if equal else -0.016) for manoeuvre in chosen],
            s=[70.0 * number for number in chosen.values()],
            marker=mark,
            color=PLAN if equal else SECOND,
            label=label,
            zorder=3,
        )
    free = {candidate.manoeuvre for candidate in plan.choice.candidates} - visits.keys()
    _crosses(
        axes,
        [(manoeuvre.length, manoeuvre.speed) for manoeuvre in free if manoeuvre.equal],
        '+',
        'not needed',
    )
    refused = {state.manoeuvre for state in plan.choice.refused}
    _crosses(
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
    axes.set_title('Where it goes (large: twice)', fontsize='medium')
    axes.margins(0.08)
    quiet(axes)
    axes.legend(fontsize='small', loc='upper center', bbox_to_anchor=(0.5, -0.12), ncols=3)


def _crosses(axes: Axes, places: list[tuple[float, float]], mark: str, label: str) -> None:
    if places:
        axes.plot(*zip(*places, strict=True), mark, color=FAINT, label=label, zorder=2)


def _known(axes: Axes, plan: TrialPlan) -> None:
    names = [f'${law.symbol}$ {what}' for what in ('value', 'slope') for law in LAWS]
    # Value and slope of a law beside each other.
    order = np.arange(len(names)).reshape(2, -1).T.ravel()
    place = np.arange(len(names))[::-1]
    axes.axvspan(1e-4, WELL_KNOWN, color=PLAN, alpha=0.08, lw=0, label='well known')
    rows: tuple[tuple[str, LawQuantities, str, str], ...] = (
        ('before', plan.before, '|', BEFORE),
        ("sweep, the paper's channels", plan.sweeps[1].known, 's', PAPER),
        ('sweep, all channels', plan.sweeps[0].known, 'D', SWEEP),
        ('plan', plan.trial.known, 'o', PLAN),
    )
    ratios = np.array([known.ratio for _, known, _, _ in rows])
    axes.hlines(place, ratios.min(0)[order], ratios.max(0)[order], color='#e3e6e8', zorder=1)
    for (label, _, mark, colour), ratio in zip(rows, ratios, strict=True):
        axes.plot(ratio[order], place, mark, color=colour, label=label, ms=6, mew=1.6)
    axes.set_xscale('log')
    axes.set_xlim(0.7 * ratios.min(), 1.4 * ratios.max())
    axes.set_yticks(place, [names[i] for i in order])
    axes.set_xlabel('standard deviation / what the law spans over 15°')
    axes.set_title('What is known of the laws of eq. 14', fontsize='medium')
    quiet(axes)
    axes.legend(fontsize='small', loc='upper center', bbox_to_anchor=(0.5, -0.12), ncols=3)
