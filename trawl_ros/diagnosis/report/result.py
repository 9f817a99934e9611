"""Content of ``diagnosis.json``: a diagnosis as plain numbers."""

import math
from collections.abc import Sequence

from trawl_ros.core.version import __version__
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.holdout import HoldoutComparison
from trawl_ros.diagnosis.naming import Named
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.repair import SourceBag
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.records.channels import CHANNELS


def result(diagnosis: Diagnosis, sources: Sequence[SourceBag]) -> dict[str, object]:
    """Build the content of ``diagnosis.json``; numbers that are not finite are null."""
    named, best = diagnosis.named, diagnosis.best
    sure = diagnosis.verdict in ('NAMED', 'AMBIGUOUS')
    ambiguous = () if named is None or best is None else (*named.rivals, *named.alike)
    return {
        'verdict': diagnosis.verdict,
        'reason': diagnosis.reason,
        'effects': _effects(diagnosis) if sure else [],
        'ambiguous_with': list(dict.fromkeys(ambiguous)) if sure else [],
        'mimics': _mimics(diagnosis),
        'onsets': _onsets(diagnosis),
        'empirical': _empirical(diagnosis),
        'where': [
            {
                'channel': where.channel,
                'variable': where.variable,
                'region': where.region,
                'z': _number(where.z),
            }
            for where in diagnosis.where
        ],
        'added': None if diagnosis.added is None else ' and '.join(diagnosis.added.refit.names),
        'evidence': {} if named is None else _evidence(named.weighed),
        'channels': _channels(diagnosis.holdout),
        'held_out': _held_out(named),
        'shown_by': diagnosis.split.by if diagnosis.holdout else None,
        'excess_removed': None if diagnosis.holdout is None else _number(diagnosis.holdout.removed),
        'excess_removed_by_placebo': (
            None if diagnosis.holdout is None else _number(diagnosis.holdout.removed_by_placebo)
        ),
        'placebo': None if diagnosis.holdout is None else diagnosis.holdout.instead,
        'coefficients': _coefficients(diagnosis.base, diagnosis.added),
        'smallest_detectable': {}
        if diagnosis.score_test is None
        else _detectable(diagnosis.score_test),
        'detection': None
        if diagnosis.score_test is None
        else {
            'strongest': _number(diagnosis.score_test.strongest),
            'limit': _number(diagnosis.score_test.limit),
        },
        'left_over': None
        if named is None
        else {
            'probability': _number(named.left_over.probability),
            'share': _number(named.left_over.share),
            'noise': None if best is None else max(best.refit.fit.scales),
        },
        'remarks': list(diagnosis.remarks),
        'next_tow': _next(diagnosis),
        'tows': [
            {'name': name, 'baseline': place in diagnosis.baseline}
            for place, name in enumerate(diagnosis.tows)
        ],
        'bags': [{'bag': source.bag, 'sha256': source.sha256} for source in sources],
        'version': __version__,
    }


def _effects(diagnosis: Diagnosis) -> list[dict[str, object]]:
    best, named = diagnosis.best, diagnosis.named
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
    if best is None or named is None:
        return stuck
    fitted: list[dict[str, object]] = [
        {
            'name': name,
            'class': [name, *named.alike],
            'parameters': {
                parameter: {'value': value, 'low': low, 'high': high, 'unit': unit}
                for parameter, (value, low, high, unit) in values.items()
            },
        }
        for name, values in values_of(best.refit).items()
    ]
    return fitted + stuck


def _onsets(diagnosis: Diagnosis) -> list[dict[str, object]]:
    return [
        {
            'tow': tow.tow,
            'minutes_watched': 0.5 * tow.watched,
            'minutes_without_a_prediction': 0.5 * tow.unwatched,
            'why_not': tow.why_not,
            'findings': [found.record() | {'minute': tow.minute(found)} for found in tow.findings],
        }
        for tow in diagnosis.onsets
    ]


def _mimics(diagnosis: Diagnosis) -> list[dict[str, object]]:
    """Changes of gear file or instruments that may be taken for what is named, or explain more."""
    listed = []
    for mimic in diagnosis.mimics:
        value, low, high = mimic.interval
        listed.append(
            {
                'name': mimic.change.name,
                'keys': list(mimic.change.keys),
                'words': str(mimic),
                'alike': [other.change.name for other in mimic.alike],
                'relative': mimic.change.relative,
                'value': value,
                'low': low,
                'high': high,
                'unit': mimic.change.unit,
                'delta_chi2': _number(mimic.delta_chi2),
                'delta_bic': _number(mimic.delta_bic),
            }
        )
    return listed


def _empirical(diagnosis: Diagnosis) -> dict[str, object] | None:
    """Empirical term, labelled as such."""
    if diagnosis.empirical is None:
        return None
    weighed, term = diagnosis.empirical.weighed, diagnosis.empirical.term
    values = values_of(weighed.refit)[term.name]
    return {
        'name': term.name,
        'label': 'empirical',
        'sentence': term.sentence,
        'nearest_reading': term.reading,
        'parameters': {
            name: {'value': value, 'low': low, 'high': high, 'unit': unit}
            for name, (value, low, high, unit) in values.items()
        },
        'delta_chi2': _number(weighed.delta_chi2),
        'delta_bic': _number(weighed.delta_bic),
        'placebo_chi2': _number(diagnosis.empirical.placebo),
        'left_over': _number(diagnosis.empirical.left_over.probability),
    }


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


def _evidence(weighed: Sequence[Weighed]) -> dict[str, object]:
    return {
        ' and '.join(entry.refit.names): {
            'delta_chi2': _number(entry.delta_chi2),
            'delta_bic': _number(entry.delta_bic),
            'held_out_gain': _number(entry.gain[0]),
            'held_out_gain_low': _number(entry.gain[1]),
            'held_out_gain_high': _number(entry.gain[2]),
            'bootstrap_share': _number(entry.share),
            'cosine': _number(entry.cosine),
        }
        for entry in weighed
    }


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


def _held_out(named: Named | None) -> dict[str, object]:
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
        for own in (() if named is None else named.held_out)
    }


def _coefficients(base: Refit | None, added: Weighed | None) -> dict[str, object]:
    if base is None:
        return {}
    return {
        name: {
            'before': {'value': base.estimate.values[i], 'std': base.estimate.std[i]},
            'after': None
            if added is None
            else {
                'value': added.refit.estimate.values[i],
                'std': added.refit.estimate.std[i],
            },
        }
        for i, name in enumerate(base.fit.prior.only('coefficients').names)
    }


def _detectable(test: ScoreTest) -> dict[str, object]:
    by_candidate: dict[str, object] = {}
    for candidate in test.wanted:
        if candidate.place:
            continue
        sizes = test.detectable(candidate)
        by_candidate[candidate.name] = {
            parameter.name: {'size': _number(size), 'unit': parameter.unit}
            for parameter, size in zip(candidate.effect.parameters, sizes, strict=True)
        }
    return by_candidate


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
