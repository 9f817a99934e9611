# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Table, sentences and JSON of the fit of the whole tow, compared with its steady windows."""

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.files import finite
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS, mnae
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.report.net import net_lines, net_result
from trawl_ros.estimation.report.report import Report, interval_row

MAX_NAMED_STRETCHES = 3
"""Largest number of badly fitting stretches that the sentence about them names."""


def motion_rows(motion: MotionOutcome, truth: FloatArray | None) -> list[dict[str, object]]:
    """Return a row for each coefficient, all without unit.

    Parameters
    ----------
    motion
        Outcome of the fit of the whole tow.
    truth : (q,) array, optional
        True coefficients, if the tow is simulated.

    Returns
    -------
    list of dict
        Prior std; values and std by the windows and by the whole tow, with the latter's 95 %
        interval; ``ratio`` of the std by the whole tow over that by the windows. The windows'
        entries are None if there is no steady window.
    """
    windows, rows = motion.windows, []
    for i, name in enumerate(motion.prior.names):
        row: dict[str, object] = {
            'name': name,
            'prior_std': float(motion.prior.std[i]),
            'windows': None if windows is None else float(windows.values[i]),
            'windows_std': None if windows is None else float(windows.std[i]),
            **interval_row(motion.estimate, truth, i),
            'ratio': None if windows is None else float(motion.ratio[i]),
        }
        rows.append(row)
    return rows


def motion_table(report: Report) -> Table:
    """Return the table of `motion_rows`; the report must have windows and a whole-tow fit."""
    motion = report.motion
    assert motion is not None
    minutes = motion.duration_s / 60.0
    table = Table(title=f'Steady windows alone, and the whole tow ({minutes:.0f} min)')
    table.add_column('', style='bold')
    headings = ['prior', 'windows', 'whole tow', 'ratio']
    if report.truth is not None:
        headings += ['truth', 'in interval']
    for heading in headings:
        table.add_column(heading, justify='right', no_wrap=True)
    for row in motion_rows(motion, report.truth):
        cells = [
            f'{row["prior_std"]:.3f}',
            f'{row["windows"]:.3f} ± {row["windows_std"]:.3f}',
            f'{row["value"]:.3f} ± {row["std"]:.3f}',
            f'{row["ratio"]:.2f}',
        ]
        if report.truth is not None:
            cells += [f'{row["truth"]:.3f}', 'yes' if row['inside'] else '[red]no[/red]']
        table.add_row(str(row['name']), *cells)
    return table


def motion_lines(report: Report) -> list[str]:
    """Return sentences on the fit of the whole tow, or the reason why it is missing."""
    motion = report.motion
    if motion is None:
        why = report.motion_refused
        return [f'Steady windows alone were used: {why}.'] if why else []
    means, fit = motion.geometric_means, motion.fit
    ratio = f', a ratio of {means["ratio"]:.2f}' if report.windows else ''
    windows = f'{means["windows"]:.3f} by the windows, ' if report.windows else ''
    lines = [
        f'Std over that of the prior, geometric mean: {windows}{means["whole"]:.3f} by the whole '
        f'tow{ratio}.',
        f'{_held_out(report, motion)}',
        f'{"Converged" if fit.converged else "NOT converged"}: {fit.reason}. Residuals are '
        f'{fit.misfit:.2f} times as large as their stated errors.',
    ]
    if report.windows:
        lines += [f'By the whole tow. {line}' for line in net_lines(fit.net)]
    for name, part in motion.left_out:
        lines.append(f'Left out: {name}, {part.begin:.0f} to {part.end:.0f} s: {part.why}.')
    if poor := motion.poor:
        places = ', '.join(
            f'{each.tow} at {each.begin:.0f} s ({each.size:.1f})'
            for each in poor[:MAX_NAMED_STRETCHES]
        )
        lines.append(f'Stretches that fit badly: {len(poor)}, the worst {places}.')
    if motion.swells:
        lines.append(_in_swell(motion.swells))
    lines += [f'Not used: {sentence}' for sentence in motion.refused]
    return lines


def _in_swell(swells: Sequence[tuple[str, float]]) -> str:
    """Return the warning about tows in a swell: their names, and std over mean of the tension."""
    swings = ', '.join(f'{100.0 * swell:.1f} % in {name}' for name, swell in swells)
    return (
        f'Within half a minute the tension swings by a part of its mean (std), {swings}: as in a '
        'swell, or with boards that are tossed about. The ship of the model lies still, so that '
        'intervals are too narrow there, and what is learned is of the gear in that swell '
        '(docs/identification/how_it_works.md).'
    )


def _held_out(report: Report, motion: MotionOutcome) -> str:
    """Return errors on held-out windows as a sentence.

    They are the mean normalised absolute errors of eq. 35, with the whole tow and with windows.
    """
    if not report.windows:
        return 'Nothing could be held out: it takes steady windows.'
    if np.isnan(motion.held_out).all():
        return 'Nothing could be held out: it takes two tows, or two states.'
    by = 'Tows' if report.held_out.by == 'tow' else 'States'
    windows = mnae(report.held_out.predicted, report.measured)
    whole = mnae(motion.held_out, report.measured)
    errors = ', '.join(
        f'{channel.words} {100.0 * new:.1f} % (windows alone {100.0 * old:.1f} %)'
        for channel, new, old in zip(PAPER_CHANNELS, whole, windows, strict=True)
    )
    return f'{by} held out: {errors}.'


def motion_result(report: Report) -> dict[str, object]:
    """Return the ``motion`` entry of ``identification.json``."""
    motion = report.motion
    if motion is None:
        return {'refused': report.motion_refused}
    fit = motion.fit
    whole = mnae(motion.held_out, report.measured)
    return {
        'coefficients': {row.pop('name'): row for row in motion_rows(motion, report.truth)},
        'covariance': fit.covariance.tolist(),
        'geometric_means': motion.geometric_means
        if report.windows
        else {'whole': motion.geometric_means['whole']},
        'mnae_held_out': {
            channel.name: finite(error)
            for channel, error in zip(PAPER_CHANNELS, whole, strict=True)
        },
        'converged': fit.converged,
        'reason': fit.reason,
        'iterations': fit.iterations,
        'net': net_result(fit.net),
        'misfit': fit.misfit,
        'sizes': fit.sizes.record(),
        'readings': fit.readings,
        'counted_s': motion.duration_s,
        'tows': list(motion.names),
        'whitened': dict(motion.spread),
        'poor_stretches': [vars(each) for each in motion.poor],
        'left_out': [{'tow': name, **vars(part)} for name, part in motion.left_out],
        'parts': [
            {'tow': linear.tow.name, **part.record()}
            for linear in fit.linear
            for part in linear.tow.statistics
        ],
        'swells': [{'tow': name, 'swing': swell} for name, swell in motion.swells],
        'not_used': list(motion.refused),
    }
