"""Diagnostic statuses of a diagnosis, for ``discrepancy/findings``."""

from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.messages.diagnostics import OK, WARN, Status

NAME = 'discrepancy'
CALM = ('NO_DISCREPANCY', 'NOT_TESTABLE')
"""Verdicts that raise no finding."""


def finding_statuses(diagnosis: Diagnosis) -> list[Status]:
    """Return the verdict's status, then one per finding: an effect, or an empirical term."""
    test = diagnosis.score_test
    values = {
        'verdict': diagnosis.verdict,
        'reason': diagnosis.reason,
        'windows': str(len(diagnosis.split.deciding) + len(diagnosis.split.kept_back)),
        'tows': str(len(diagnosis.tows)),
    }
    if test is not None:
        values |= {'evidence': f'{test.strongest:.2f}', 'limit': f'{test.limit:.2f}'}
    for where in diagnosis.where:
        values.setdefault(f'{where.channel} {where.variable}', f'{where.region}, z {where.z:.1f}')
    level = OK if diagnosis.verdict in CALM else WARN
    statuses = [Status(f'{NAME}: verdict', level, headline(diagnosis), values)]
    repair = diagnosis.repair
    if repair is None and diagnosis.verdict == 'AMBIGUOUS':
        repair = diagnosis.best
    if repair is not None:
        kind = 'empirical term' if diagnosis.empirical is not None else 'effect'
        more = {
            'verdict': diagnosis.verdict,
            'delta chi2': f'{repair.delta_chi2:.1f}',
            'delta bic': f'{repair.delta_bic:.1f}',
            'bootstrap share': f'{repair.share:.2f}',
        }
        statuses += [
            Status(f'{NAME}: {name}', WARN, f'{kind} {name}', own | more)
            for name, own in _sizes(repair.refit).items()
        ]
    return statuses


def _sizes(refit: Refit) -> dict[str, dict[str, str]]:
    by_effect: dict[str, dict[str, str]] = {}
    for name, values in values_of(refit).items():
        by_effect[name] = {}
        for parameter, (value, low, high, unit) in values.items():
            by_effect[name] |= {
                parameter: f'{value:.6g}',
                f'{parameter} low': f'{low:.6g}',
                f'{parameter} high': f'{high:.6g}',
                f'{parameter} unit': unit,
            }
    return by_effect
