# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Figure of what a fit of the whole tow adds to its steady windows."""

import numpy as np
from matplotlib.figure import Figure

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.report.figures_coefficients import SHADED
from trawl_ros.report.style import FAINT, MEASURED, PORT, SECOND, quiet


def motion_figure(motion: MotionOutcome, truth: FloatArray | None) -> Figure:
    """Both estimates with their intervals in prior std, and their std over that of the prior."""
    figure = Figure(figsize=(10.0, 6.0), layout='constrained')
    estimates, shares = figure.subplots(2, 1, sharex=True, height_ratios=(1.6, 1.0))
    place, prior = np.arange(len(motion.prior)), motion.prior
    assert motion.windows is not None
    both = (
        ('steady windows', motion.windows.values, motion.windows.std, SECOND, -0.15),
        ('whole tow', motion.fit.values, motion.estimate.std, MEASURED, 0.15),
    )
    for words, values, std, colour, beside in both:
        estimates.errorbar(
            place + beside, prior.departure(values), SHADED * std / prior.std, fmt='o',
            color=colour, capsize=3, ms=4, label=f'{words}, 95 % interval',
        )  # fmt: skip
        shares.bar(place + beside, std / prior.std, 0.3, color=colour, label=words)
    if truth is not None:
        estimates.plot(
            place, prior.departure(truth), 'D', mfc='none', mew=1.5, color=PORT, label='truth'
        )
    estimates.axhline(0.0, color=FAINT, lw=1.0)
    estimates.set_ylabel('departure from the start / prior std')
    shares.axhline(1.0, color=FAINT, lw=1.0, ls='--')
    shares.set_ylabel("std / prior's std")
    shares.set_xticks(place, prior.names)
    means = motion.geometric_means
    shares.set_title(
        f'geometric mean {means["windows"]:.2f} by the windows, {means["whole"]:.2f} by all of '
        'the tow',
        loc='left', fontsize='medium',
    )  # fmt: skip
    for axes in (estimates, shares):
        quiet(axes)
        axes.legend(fontsize='small', loc='upper left', bbox_to_anchor=(1.0, 1.0), frameon=False)
    return figure
