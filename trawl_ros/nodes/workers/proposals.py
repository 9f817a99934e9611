# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proposals for a trial as a diagnostic status, in ``identification/status``."""

import re
from collections.abc import Sequence

from trawl_ros.control.trial.records import Knowledge, Proposal, TrialTarget
from trawl_ros.core.errors import MessageError
from trawl_ros.messages.diagnostics import OK, WARN, Status, read_number

NAME = 'identification: proposals'
NOW = 'now'

_COLUMNS = ('port_warp', 'starboard_warp', 'speed', 'minutes', 'gain', 'rate', 'tension', 'deepest')
_KEY = re.compile(rf'(\d{{1,4}}) ({"|".join(_COLUMNS)})')


def knowledge_status(knowledge: Knowledge) -> Status:
    """Return what the estimator knows and proposes, as numbers by name."""
    values = {
        'windows': str(knowledge.windows),
        'advised': str(knowledge.advised),
        'looked up': f'{knowledge.looked_up:.4f}',
    }
    values |= {f'{name} {NOW}': f'{ratio:.6g}' for name, ratio in knowledge.ratios.items()}
    for number, proposal in enumerate(knowledge.proposals, 1):
        target = proposal.target
        numbers = (
            target.port,
            target.starboard,
            target.speed,
            proposal.minutes,
            proposal.nats,
            proposal.rate,
            proposal.tension,
            proposal.deepest,
        )
        for column, value in zip(_COLUMNS, numbers, strict=True):
            values[f'{number} {column}'] = f'{value:.9g}'
    if knowledge.trouble:
        return Status(NAME, WARN, knowledge.trouble, values)
    message = f'{len(knowledge.proposals)} manoeuvres after {knowledge.advised} windows'
    return Status(NAME, OK, message, values)


def read_knowledge(statuses: Sequence[Status]) -> Knowledge | None:
    """Read what the estimator knows; None where no status says it.

    Raises
    ------
    MessageError
        If a number is none, or a proposal lacks one.
    """
    status = next((status for status in statuses if status.name == NAME), None)
    if status is None:
        return None
    rows: dict[int, dict[str, float]] = {}
    ratios: dict[str, float] = {}
    for key in status.values:
        if match := _KEY.fullmatch(key):
            rows.setdefault(int(match[1]), {})[match[2]] = read_number(status, key)
        elif key.endswith(f' {NOW}'):
            ratios[key.removesuffix(f' {NOW}')] = read_number(status, key)
    return Knowledge(
        windows=int(read_number(status, 'windows')),
        ratios=ratios,
        advised=int(read_number(status, 'advised')),
        looked_up=read_number(status, 'looked up'),
        proposals=tuple(_proposal(number, rows[number]) for number in sorted(rows)),
        trouble='' if status.level == OK else status.message,
    )


def _proposal(number: int, row: dict[str, float]) -> Proposal:
    if missing := [column for column in _COLUMNS if column not in row]:
        raise MessageError(f'{NAME}: proposal {number} lacks {", ".join(missing)}; expected all')
    port, starboard, speed, minutes, nats, rate, tension, deepest = (row[name] for name in _COLUMNS)
    target = TrialTarget(port=port, starboard=starboard, speed=speed)
    return Proposal(target, minutes, nats, rate, tension, deepest)
