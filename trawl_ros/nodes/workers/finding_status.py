# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Diagnostic statuses of a diagnosis and of what begins, for ``discrepancy/findings``."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from trawl_ros.core.time import SECOND
from trawl_ros.diagnosis.diagnosis import Diagnosis, values_of
from trawl_ros.diagnosis.onset.findings import Finding
from trawl_ros.diagnosis.report.sentences import headline
from trawl_ros.effects.catalogue.instruments import FROZEN_SENSOR as FROZEN
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status

if TYPE_CHECKING:
    from trawl_ros.diagnosis.onset.monitor import OnsetMonitor

NAME = 'discrepancy'
CALM = ('NO_DISCREPANCY', 'NOT_TESTABLE')
"""Verdicts that raise no finding."""

MOST_CAUSES = 10
"""Number of causes whose probability the verdict's status has."""


def finding_statuses(diagnosis: Diagnosis) -> list[Status]:
    """Return the verdict's status with the probabilities, then one per cause that is likely."""
    posterior = diagnosis.posterior
    values = {
        'verdict': diagnosis.verdict,
        'reason': diagnosis.reason,
        'windows': str(len(diagnosis.split.fitted) + len(diagnosis.split.kept_back)),
        'tows': str(len(diagnosis.tows)),
    }
    if posterior is not None:
        values |= {
            'probability boards alone': f'{posterior.nothing:.4f}',
            'probability something else': f'{posterior.unknown:.4f}',
        }
        for name, probability in list(posterior.leaves.items())[:MOST_CAUSES]:
            values[f'probability {name}'] = f'{probability:.4f}'
    for where in diagnosis.where:
        values.setdefault(f'{where.channel} {where.variable}', f'{where.region}, z {where.z:.1f}')
    level = OK if diagnosis.verdict in CALM else WARN
    statuses = [Status(f'{NAME}: verdict', level, headline(diagnosis), values)]
    statuses += [
        Status(f'{NAME}: {FROZEN.name} {sensor.channel}', WARN, sensor.sentence)
        for sensor in diagnosis.frozen
    ]
    best = diagnosis.best if diagnosis.verdict in ('NAMED', 'AMBIGUOUS') else None
    if best is None or best.refit is None or posterior is None:
        return statuses
    for suspect, own in zip(best.suspects, values_of(best).values(), strict=True):
        name = suspect.entry.name
        more = {
            'verdict': diagnosis.verdict,
            'node': suspect.entry.node.path,
            'probability': f'{posterior.leaves[name]:.4f}',
            'node probability': f'{posterior.nodes[suspect.entry.node.path]:.4f}',
        }
        statuses.append(Status(f'{NAME}: {name}', WARN, f'cause {name}', _sizes(own) | more))
    return statuses


def _sizes(values: Mapping[str, tuple[float, float, float, str]]) -> dict[str, str]:
    sizes: dict[str, str] = {}
    for parameter, (value, low, high, unit) in values.items():
        sizes |= {
            parameter: f'{value:.6g}',
            f'{parameter} low': f'{low:.6g}',
            f'{parameter} high': f'{high:.6g}',
            f'{parameter} unit': unit,
        }
    return sizes


def onset_status(finding: Finding, acknowledged: bool) -> Status:
    """Status of a finding of what has begun; one that was dismissed or withdrawn is calm."""
    values = {
        'state': finding.state,
        'acknowledged': str(acknowledged).lower(),
        'onset': f'{finding.onset_ns / SECOND:.3f}',
        'onset low': f'{finding.onset_low_ns / SECOND:.3f}',
        'onset high': f'{finding.onset_high_ns / SECOND:.3f}',
        'raised': f'{finding.raised_ns / SECOND:.3f}',
        'similar evidence': ', '.join(finding.alike),
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
