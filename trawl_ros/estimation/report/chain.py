# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Sentences and JSON on the fit of tows as chains of parts."""

from collections.abc import Sequence

from trawl_ros.estimation.motion.towing.lineariser import MOVES
from trawl_ros.estimation.report.report import Report

MAX_NAMED_STRETCHES = 3
"""Largest number of badly fitting stretches that the sentence about them names."""


def chain_lines(report: Report) -> list[str]:
    """Return sentences on what fits badly or was left out, or the reason why it was not fitted."""
    chain = report.chain
    if chain is None:
        why = report.chain_refused
        return [f'The estimate is of the steady windows alone: {why}.'] if why else []
    lines = []
    for name, part in chain.left_out:
        if part.why == MOVES:
            continue
        lines.append(f'Left out: {name}, {part.begin:.0f} to {part.end:.0f} s: {part.why}.')
    if poor := chain.poor:
        places = ', '.join(
            f'{each.tow} at {each.begin:.0f} s ({each.size:.1f})'
            for each in poor[:MAX_NAMED_STRETCHES]
        )
        lines.append(f'Stretches that fit badly: {len(poor)}, the worst {places}.')
    if chain.swells:
        lines.append(_in_swell(chain.swells))
    return [*lines, *(f'Not used: {sentence}' for sentence in chain.refused)]


def _in_swell(swells: Sequence[tuple[str, float]]) -> str:
    """Return the warning about tows in a swell: their names, and std over mean of the tension."""
    swings = ', '.join(f'{100.0 * swell:.1f} % in {name}' for name, swell in swells)
    return (
        f'Within half a minute the tension swings by a part of its mean (std), {swings}: as in a '
        'swell, or with boards that are tossed about. The ship of the model lies still, so that '
        'intervals are too narrow there, and what is learned is of the gear in that swell '
        '(docs/identification/how_it_works.md).'
    )


def chain_result(report: Report) -> dict[str, object]:
    """Return the ``chain`` entry of ``identification.json``."""
    chain = report.chain
    if chain is None:
        return {'refused': report.chain_refused}
    fit = chain.fit
    return {
        'fitted': chain.what,
        'iterations': fit.iterations,
        'sizes': fit.sizes.record(),
        'readings': fit.readings,
        'counted_s': chain.duration_s,
        'tows': list(chain.names),
        'whitened': dict(chain.spread),
        'poor_stretches': [vars(each) for each in chain.poor],
        'left_out': [{'tow': name, **vars(part)} for name, part in chain.left_out],
        'parts': [
            {'tow': linear.tow.name, **part.record()}
            for linear in fit.linear
            for part in linear.tow.statistics
        ],
        'swells': [{'tow': name, 'swing': swell} for name, swell in chain.swells],
        'not_used': list(chain.refused),
    }
