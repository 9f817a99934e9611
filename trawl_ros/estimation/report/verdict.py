# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Verdict on an identification, in sentences; the first one is the verdict itself."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.report.net import net_lines
from trawl_ros.estimation.report.report import Report
from trawl_ros.estimation.report.residuals import ChannelResiduals

LARGEST_TEST_RATIO = 1.0
"""Test ratio above which residuals are beyond what the stated errors allow."""

GRAVE_REASONS = ('wrong unit', 'implausible', 'speed over ground')
"""Reasons of a rejection that one should not have to look for."""

NOTABLE_MISFIT = 1.2
"""Misfit from where it is worth a word."""

NOTABLE_NOISE = 2.0
"""Scatter over what is stated from where it is worth a word."""


@dataclass(frozen=True)
class Verdict:
    """Verdict: sentences on one identification.

    Attributes
    ----------
    fit
        Quality of the hold-out predictions.
    holds
        True if that is at least as good as the paper's own fit in every channel, and the
        iteration at rest.
    knowledge
        Number of coefficients that the data determine, and the combinations they do not.
    concerns
        Reasons against trusting it, most weighty first; empty without any.
    """

    fit: str
    holds: bool
    knowledge: tuple[str, ...]
    concerns: tuple[str, ...]


def verdict(report: Report) -> Verdict:
    """Return the verdict on a report."""
    held = report.errors['held_out']
    paper = np.array([channel.paper for channel in PAPER_CHANNELS])
    return Verdict(
        fit=_fit(report, held, paper),
        holds=report.estimate.converged and bool(np.all(held <= paper)),
        knowledge=_knowledge(report),
        concerns=_concerns(report),
    )


def _fit(report: Report, held: FloatArray, paper: FloatArray) -> str:
    out = report.held_out
    if not report.windows:
        return (
            f'No steady window was found, so nothing could be left out: {report.source}, were '
            "fitted from the gear file's prior."
        )
    if not np.all(np.isfinite(held)):
        return (
            f'Nothing could be left out and predicted from the rest ({_count(out.groups, out.by)} '
            'in the data), so how good the fit is remains unknown.'
        )
    listed = ', '.join(
        f'{channel.words} {100.0 * error:.1f} %'
        for channel, error in zip(PAPER_CHANNELS, held, strict=True)
    )
    worse = [c.words for c, error in zip(PAPER_CHANNELS, held, strict=True) if error > c.paper]
    if worse:
        beside = f'worse than the paper fits its own points in {" and ".join(worse)}'
    elif np.all(held <= 0.5 * paper):
        beside = 'less than half of what the paper has on the points it fitted'
    else:
        beside = 'no more than the paper has on the points it fitted'
    left = 'Tows' if out.by == 'tow' else 'Steady states of this one tow'
    return f'{left} left out of the fit are predicted with an error of {listed}: {beside}.'


def _knowledge(report: Report) -> tuple[str, ...]:
    if report.paired:
        only = 'The gear has no boards: drag and weight of its net are estimated.'
        return only, *net_lines(report.estimate.net)
    estimate = report.estimate
    known = [name for name, flag in zip(estimate.names, estimate.determined, strict=True) if flag]
    listed = f': {", ".join(known)}' if known else ''
    sentences = [
        f'The data determine {len(known)} of the {len(estimate.names)} coefficients{listed}.'
    ]
    if estimate.undetermined:
        names = '; '.join(str(combination) for combination in estimate.undetermined)
        sentences.append(f'Known no better than before any tow: {names}.')
    sentences += net_lines(report.estimate.net)
    if report.laws is not None:
        well = report.laws.quantities.well_known
        lacking = [name for name, flag in zip(QUANTITIES, well, strict=True) if not flag]
        listed = f'; not {", ".join(lacking)}' if lacking else ''
        sentences.append(
            f'At the angles the boards work at, {int(well.sum())} of the {len(well)} values and '
            f'slopes of their laws are known to a fifth of what the law spans over 15°{listed}.'
        )
    return tuple(sentences)


def _concerns(report: Report) -> tuple[str, ...]:
    estimate = report.estimate
    concerns = [
        f'Refused, {reason}: {report.found[reason]}.'
        for reason in GRAVE_REASONS
        if reason in report.found
    ]
    if not estimate.converged:
        concerns.append(f'The iteration has not converged: {estimate.reason}.')
    if estimate.active_bounds:
        bounds = '; '.join(estimate.active_bounds)
        concerns.append(f'On a bound, so that its interval is worth little: {bounds}.')
    if report.misfit > NOTABLE_MISFIT:
        widened = 'are widened as much' if report.chain is None else 'may be too narrow'
        concerns.append(
            f'The readings differ from the model by {report.misfit:.1f} times what all known '
            f'errors explain; intervals {widened}.'
        )
    if beyond := [_ratio(row) for row in report.residuals if row.test_ratio > LARGEST_TEST_RATIO]:
        concerns.append(
            f'Residuals are beyond what the stated errors allow in {", ".join(beyond)}.'
        )
    if coloured := [row for row in report.residuals if row.whiteness and not row.whiteness.white]:
        names = ', '.join(_words(row) for row in coloured)
        concerns.append(
            f'Residuals follow each other, rather than scatter, in {names}: something that '
            'changes slowly is not in the model.'
        )
    if noisy := [
        f'{group.replace("_", " ")} ({scale:.1f} times)'
        for group, scale in estimate.noise_scales.items()
        if scale > NOTABLE_NOISE
    ]:
        concerns.append(f'Readings scatter far more than stated in {", ".join(noisy)}.')
    if report.held_out.by == 'state':
        concerns.append(
            'There is one tow only: errors of calibration are in what was fitted and in what was '
            'left out alike.'
        )
    return tuple(concerns)


def _ratio(row: ChannelResiduals) -> str:
    return f'{_words(row)} (test ratio {row.test_ratio:.1f})'


def _words(row: ChannelResiduals) -> str:
    return row.channel.replace('_', ' ')


def _count(number: int, word: str) -> str:
    kind = 'steady state' if word == 'state' else word
    return f'{number} {kind}' if number == 1 else f'{number} {kind}s'
