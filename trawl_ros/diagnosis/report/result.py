# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Content of ``diagnosis.json``: a diagnosis as plain numbers."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict

from trawl_ros.core.version import __version__
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.holdout import HoldoutComparison
from trawl_ros.diagnosis.inference.posterior import Explanation
from trawl_ros.diagnosis.inference.refit import Refit
from trawl_ros.diagnosis.inference.screen import detectable
from trawl_ros.diagnosis.library.gear_file_change import GearFileChange
from trawl_ros.diagnosis.repair import SourceBag
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.records.channels import CHANNELS

WORTH_A_LINE = 0.001
"""Probability below which a hypothesis has no line of its own."""


def result(diagnosis: Diagnosis, sources: Sequence[SourceBag]) -> dict[str, object]:
    """Build the content of ``diagnosis.json``; numbers that are not finite are null."""
    sure = diagnosis.verdict in ('NAMED', 'AMBIGUOUS')
    posterior, best = diagnosis.posterior, diagnosis.best
    own = () if best is None else best.names
    added = best if diagnosis.verdict != 'NO_DISCREPANCY' else None
    return {
        'verdict': diagnosis.verdict,
        'reason': diagnosis.reason,
        'probability': None
        if posterior is None
        else {
            'no_discrepancy': posterior.nothing,
            'something_else': posterior.unknown,
            'leaves': _listed(posterior.leaves.items()),
            'nodes': _listed(posterior.nodes.items()),
        },
        'effects': _effects(diagnosis) if sure else [],
        'ambiguous_with': [name for name in diagnosis.among if name not in own] if sure else [],
        'mimics': _changes(diagnosis) if sure else [],
        'onsets': _onsets(diagnosis),
        'empirical': _patterns(diagnosis),
        'boards_moved': None
        if diagnosis.moved is None
        else {
            'std': diagnosis.moved.std,
            'coefficient': diagnosis.moved.coefficient,
            'spread_m': diagnosis.moved.spread,
            'depth_m': diagnosis.moved.depth,
        },
        'where': [
            {
                'channel': where.channel,
                'variable': where.variable,
                'region': where.region,
                'z': _number(where.z),
            }
            for where in diagnosis.where
        ],
        'added': None if added is None else ' and '.join(added.names),
        'evidence': _evidence(diagnosis),
        'channels': _channels(diagnosis.holdout),
        'held_out': _held_out(diagnosis),
        'shown_by': diagnosis.split.by if diagnosis.holdout else None,
        'excess_removed': None if diagnosis.holdout is None else _number(diagnosis.holdout.removed),
        'excess_removed_by_placebo': (
            None if diagnosis.holdout is None else _number(diagnosis.holdout.removed_by_placebo)
        ),
        'placebo': None if diagnosis.holdout is None else diagnosis.holdout.instead,
        'coefficients': _coefficients(diagnosis.base, None if added is None else added.refit),
        'smallest_detectable': _detectable(diagnosis),
        'remarks': list(diagnosis.remarks),
        'next_tow': _next(diagnosis),
        'tows': [
            {'name': name, 'baseline': place in diagnosis.baseline}
            for place, name in enumerate(diagnosis.tows)
        ],
        'bags': [{'bag': source.bag, 'sha256': source.sha256} for source in sources],
        'version': __version__,
    }


def _listed(pairs: Iterable[tuple[str, float]]) -> dict[str, float]:
    return {name: probability for name, probability in pairs if probability >= WORTH_A_LINE}


def _effects(diagnosis: Diagnosis) -> list[dict[str, object]]:
    best, posterior = diagnosis.best, diagnosis.posterior
    stuck: list[dict[str, object]] = [
        {
            'name': FROZEN.name,
            'class': [FROZEN.name],
            'tow': diagnosis.tows[sensor.tow],
            'channel': sensor.channel,
            'parameters': {
                'value': {
                    'value': sensor.value,
                    'low': sensor.value - 2.0 * sensor.std,
                    'high': sensor.value + 2.0 * sensor.std,
                    'unit': CHANNELS[sensor.channel].unit,
                }
            },
        }
        for sensor in diagnosis.frozen
    ]
    if best is None or best.refit is None or posterior is None:
        return stuck
    leaves, nodes = posterior.leaves, posterior.nodes
    fitted: list[dict[str, object]] = []
    for suspect, values in zip(best.suspects, values_of(best).values(), strict=True):
        name, path = suspect.entry.name, suspect.entry.node.path
        same = [own for own in diagnosis.among if posterior.entry(own).entry.node.path == path]
        fitted.append(
            {
                'name': name,
                'class': list(dict.fromkeys((name, *same))),
                'probability': leaves[name],
                'node': path,
                'node_probability': nodes[path],
                'named': next(
                    (
                        own.path
                        for own in diagnosis.named
                        if suspect.entry.path.startswith(own.path)
                    ),
                    None,
                ),
                'parameters': {
                    parameter: {'value': value, 'low': low, 'high': high, 'unit': unit}
                    for parameter, (value, low, high, unit) in values.items()
                },
            }
        )
    return fitted + stuck


def _onsets(diagnosis: Diagnosis) -> list[dict[str, object]]:
    return [
        {
            'tow': tow.tow,
            'minutes_watched': 0.5 * tow.watched,
            'minutes_without_a_prediction': 0.5 * tow.unwatched,
            'why_not': tow.why_not,
            'findings': [asdict(found) | {'minute': tow.minute(found)} for found in tow.findings],
        }
        for tow in diagnosis.onsets
    ]


def _changes(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """Changes of the gear file that are not excluded, the likeliest first."""
    listed: list[dict[str, object]] = []
    assert diagnosis.posterior is not None
    for name in diagnosis.among:
        suspect = diagnosis.posterior.entry(name)
        change = suspect.entry.effect
        if not isinstance(change, GearFileChange):
            continue
        alone = [
            own
            for own in diagnosis.posterior.explanations
            if own.names == (name,) and own.refit is not None
        ]
        value, low, high, _ = values_of(alone[0])[name]['change'] if alone else (math.nan,) * 4
        listed.append(
            {
                'name': name,
                'keys': list(change.record.keys),
                'words': change.words(value) if alone else change.sentence,
                'probability': diagnosis.posterior.leaves[name],
                'relative': change.record.relative,
                'value': _number(value),
                'low': _number(low),
                'high': _number(high),
                'unit': change.record.unit,
            }
        )
    return listed


def _patterns(diagnosis: Diagnosis) -> dict[str, object] | None:
    """Return the patterns of something that the library does not have, where that is likely."""
    posterior, screen = diagnosis.posterior, diagnosis.screen
    if diagnosis.verdict != 'UNKNOWN' or posterior is None or screen is None:
        return None
    for own in posterior.explanations:
        if own.unknown is not None:
            return {
                'label': 'something else',
                'probability': posterior.unknown,
                'patterns': [
                    {
                        'channel': screen.patterns[place].channel,
                        'variable': screen.patterns[place].shape,
                        'size': size,
                    }
                    for place, size in zip(own.unknown.places, own.unknown.sizes, strict=True)
                ],
            }
    return None


def _next(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """Checks, which need no tow, and tows with the gain of χ² per hour."""
    checks: list[dict[str, object]] = [
        {'sentence': check, 'states': []} for check in diagnosis.checks
    ]
    return checks + [
        {
            'sentence': str(proposal),
            'states': [
                {'warp_length': length, 'speed': speed} for length, speed in proposal.states
            ],
            'reciprocal': proposal.reciprocal,
            'hours': proposal.hours,
            'delta_chi2_per_hour': _number(proposal.per_hour),
        }
        for proposal in diagnosis.proposals
    ]


def _evidence(diagnosis: Diagnosis) -> dict[str, object]:
    """Return the evidence of each explanation that is worth a line, the likeliest first."""
    if diagnosis.posterior is None:
        return {}
    return {
        _words_of(own): {
            'probability': own.probability,
            'log_bayes_factor': _number(own.log_factor),
            'log_prior_odds': own.log_odds,
            'refitted': own.refit is not None,
            **(
                {}
                if own.refit is None
                else dict(zip(('delta_chi2', 'delta_bic'), diagnosis.lowered(own), strict=True))
            ),
        }
        for own in diagnosis.posterior.explanations
        if own.probability >= WORTH_A_LINE
    }


def _words_of(own: Explanation) -> str:
    names = (*own.names, *(('something_else',) if own.unknown else ()))
    return ' and '.join(names) or 'boards_alone'


def _channels(holdout: HoldoutComparison | None) -> dict[str, object]:
    if holdout is None:
        return {}
    return {
        name: {
            'unit': CHANNELS[name].unit,
            'before': _number(before),
            'after': None if holdout.after is None else _number(holdout.after.rms.get(name)),
            'placebo': None if holdout.placebo is None else _number(holdout.placebo.rms.get(name)),
            'expected': _number(holdout.before.expected[name]),
        }
        for name, before in holdout.before.rms.items()
    }


def _held_out(diagnosis: Diagnosis) -> dict[str, object]:
    """χ² of each quantity on what was kept back, errors of calibration and all others counted."""
    return {
        own.name: {
            'before': _number(own.before),
            'after': _number(own.after),
            'readings': own.number,
            'probability': _number(own.probability),
            'part': _number(own.part),
            'part_std': _number(own.part_std),
        }
        for own in diagnosis.held_out
    }


def _coefficients(base: Refit | None, added: Refit | None) -> dict[str, object]:
    if base is None:
        return {}
    return {
        name: {
            'before': {'value': base.estimate.values[i], 'std': base.estimate.std[i]},
            'after': None
            if added is None
            else {
                'value': added.estimate.values[i],
                'std': added.estimate.std[i],
            },
        }
        for i, name in enumerate(base.fit.prior.only('coefficients').names)
    }


def _detectable(diagnosis: Diagnosis) -> dict[str, object]:
    """Return the size of each value, alone, whose evidence holds the cut in four of five trials."""
    if diagnosis.screen is None:
        return {}
    by_cause: dict[str, object] = {}
    for suspect in diagnosis.screen.suspects:
        if suspect.candidate.place:
            continue
        sizes = suspect.candidate.scale * detectable(diagnosis.screen, suspect)
        by_cause[suspect.entry.name] = {
            parameter.name: {'size': _number(size), 'unit': parameter.unit}
            for parameter, size in zip(suspect.entry.effect.parameters, sizes, strict=True)
        }
    return by_cause


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
