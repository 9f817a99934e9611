"""Diagnostic statuses of a diagnosis and of what begins, for ``discrepancy/findings``."""

from typing import TYPE_CHECKING

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.refit import Refit
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.monitor import OnsetMonitor

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
    statuses += [
        Status(f'{NAME}: {FROZEN.name} {sensor.channel}', WARN, sensor.sentence)
        for sensor in diagnosis.frozen
    ]
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


def onset_status(finding: Finding, acknowledged: bool) -> Status:
    """Status of a finding of what has begun; one that was dismissed or withdrawn is calm."""
    values = {
        'state': finding.state,
        'acknowledged': str(acknowledged).lower(),
        'onset': f'{finding.onset_ns / SECOND:.3f}',
        'onset low': f'{finding.onset_low_ns / SECOND:.3f}',
        'onset high': f'{finding.onset_high_ns / SECOND:.3f}',
        'raised': f'{finding.raised_ns / SECOND:.3f}',
        'not told from': ', '.join(finding.alike),
        'rarity': f'{finding.rarity:.1f}',
        'limit': f'{finding.limit:.1f}',
    }
    for name, one in finding.values.items():
        values |= {
            name: f'{one.value:.6g}',
            f'{name} low': f'{one.low:.6g}',
            f'{name} high': f'{one.high:.6g}',
            f'{name} unit': one.unit,
        }
    level = WARN if finding.state in ('raised', 'settled') else OK
    return Status(f'{NAME}: onset {finding.number}', level, finding.sentence(), values)


def onset_watch_status(monitor: 'OnsetMonitor', trouble: str) -> Status:
    """Status of the watch for what begins; without a prediction it says why."""
    watched, unwatched = monitor.watched, monitor.unwatched
    values = {
        'stretches watched': str(watched),
        'stretches without a prediction': str(unwatched),
        'findings': str(len(monitor.findings)),
    }
    if trouble:
        return Status('onset', ERROR, trouble, values)
    if (found := monitor.open) is not None:
        return Status('onset', WARN, found.sentence(), values)
    if monitor.withheld:
        return Status('onset', WARN, monitor.withheld, values)
    if monitor.why_not:
        return Status('onset', OK, f'not watching: {monitor.why_not}', values)
    return Status('onset', OK, 'watching', values)
