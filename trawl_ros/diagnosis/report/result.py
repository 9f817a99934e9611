"""Content of ``diagnosis.json``: a diagnosis as plain numbers."""

import math
from collections.abc import Sequence

from trawl_ros.core.version import __version__
from trawl_ros.diagnosis.diagnosis import Diagnosis, HoldoutComparison, values_of
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.repair import SourceBag
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import Weighed
from trawl_ros.records.channels import CHANNELS


def result(found: Diagnosis, sources: Sequence[SourceBag]) -> dict[str, object]:
    """Build the content of ``diagnosis.json``; numbers that are not finite are null."""
    named, best = found.named, found.best
    sure = found.verdict in ('NAMED', 'AMBIGUOUS')
    ambiguous = () if named is None or best is None else (*named.rivals, *named.alike)
    return {
        'verdict': found.verdict,
        'reason': found.reason,
        'effects': _effects(found) if sure else [],
        'ambiguous_with': list(dict.fromkeys(ambiguous)) if sure else [],
        'empirical': _empirical(found),
        'where': [
            {
                'channel': where.channel,
                'variable': where.variable,
                'region': where.region,
                'z': _number(where.z),
            }
            for where in found.where
        ],
        'added': None if found.added is None else ' and '.join(found.added.refit.names),
        'evidence': {} if named is None else _evidence(named.weighed),
        'channels': _channels(found.shown),
        'shown_by': found.split.by if found.shown else None,
        'excess_removed': None if found.shown is None else _number(found.shown.removed),
        'excess_removed_by_placebo': (
            None if found.shown is None else _number(found.shown.removed_by_placebo)
        ),
        'placebo': None if found.shown is None else found.shown.instead,
        'coefficients': _coefficients(found.base, found.added),
        'smallest_detectable': {} if found.seen is None else _detectable(found.seen),
        'detection': None
        if found.seen is None
        else {'strongest': _number(found.seen.strongest), 'limit': _number(found.seen.limit)},
        'left_over': None
        if named is None
        else {
            'probability': _number(named.left_over.probability),
            'share': _number(named.left_over.share),
            'noise': None if best is None else max(best.refit.fit.scales),
        },
        'remarks': list(found.remarks),
        'next_tow': _next(found),
        'tows': [
            {'name': name, 'baseline': place in found.baseline}
            for place, name in enumerate(found.tows)
        ],
        'bags': [{'bag': one.bag, 'sha256': one.sha256} for one in sources],
        'version': __version__,
    }


def _effects(found: Diagnosis) -> list[dict[str, object]]:
    best, named = found.best, found.named
    if best is None or named is None:
        return []
    return [
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


def _empirical(found: Diagnosis) -> dict[str, object] | None:
    """Empirical term, labelled as such."""
    if found.empirical is None:
        return None
    weighed, term = found.empirical.weighed, found.empirical.term
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
        'placebo_chi2': _number(found.empirical.placebo),
        'left_over': _number(found.empirical.left_over.probability),
    }


def _next(found: Diagnosis) -> list[dict[str, object]]:
    """Checks, which need no tow, and tows with the gain of χ² per hour."""
    checks: list[dict[str, object]] = [{'sentence': check, 'states': []} for check in found.checks]
    return checks + [
        {
            'sentence': str(one),
            'states': [{'warp_length': length, 'speed': speed} for length, speed in one.states],
            'reciprocal': one.reciprocal,
            'hours': one.hours,
            'delta_chi2_per_hour': _number(one.per_hour),
        }
        for one in found.proposals
    ]


def _evidence(weighed: Sequence[Weighed]) -> dict[str, object]:
    return {
        ' and '.join(one.refit.names): {
            'delta_chi2': _number(one.delta_chi2),
            'delta_bic': _number(one.delta_bic),
            'held_out_gain': _number(one.gain[0]),
            'held_out_gain_low': _number(one.gain[1]),
            'held_out_gain_high': _number(one.gain[2]),
            'bootstrap_share': _number(one.share),
            'cosine': _number(one.cosine),
        }
        for one in weighed
    }


def _channels(shown: HoldoutComparison | None) -> dict[str, object]:
    if shown is None:
        return {}
    return {
        name: {
            'unit': CHANNELS[name].unit,
            'before': _number(before),
            'after': None if shown.after is None else _number(shown.after.rms.get(name)),
            'placebo': None if shown.placebo is None else _number(shown.placebo.rms.get(name)),
            'expected': _number(shown.before.expected[name]),
        }
        for name, before in shown.before.rms.items()
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


def _detectable(seen: ScoreTest) -> dict[str, object]:
    found: dict[str, object] = {}
    for candidate in seen.wanted:
        if candidate.place:
            continue
        sizes = seen.detectable(candidate)
        found[candidate.name] = {
            parameter.name: {'size': _number(size), 'unit': parameter.unit}
            for parameter, size in zip(candidate.effect.parameters, sizes, strict=True)
        }
    return found


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)
