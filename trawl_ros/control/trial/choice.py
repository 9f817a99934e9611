# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Choice of the next target among the estimator's proposals, within the trial's limits."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from trawl_ros.control.trial.memory import TowedState
from trawl_ros.control.trial.records import (
    Knowledge,
    Proposal,
    TrialSettings,
    TrialTarget,
)

MAX_VISITS = 2
"""Largest number of visits to one state, because its expected gain rests on uncertain boards."""


@dataclass(frozen=True)
class Choice:
    """Choice: the best allowed proposal, or None, and the reasons against the others.

    ``refused`` counts proposals by reason.
    """

    proposal: Proposal | None
    refused: Counter[str]

    @property
    def late(self) -> bool:
        """True if none is allowed, but some would be with more time."""
        return self.proposal is None and self.refused['time'] > 0

    def __str__(self) -> str:
        refused = ', '.join(f'{reason} {number}' for reason, number in self.refused.items())
        return f'none of {self.refused.total()} proposals is allowed ({refused or "none came"})'


def waiting_for_advice(knowledge: Knowledge, settings: TrialSettings, waited: float) -> str:
    """Return the missing advice after ``waited`` seconds; '' if a target can be chosen."""
    if knowledge.windows == 0:
        return 'for the first window'
    patient = waited < settings.advice_patience
    if knowledge.advised < knowledge.windows and (patient or not knowledge.proposals):
        wish = f'for advice after {knowledge.windows} windows, for {waited / 60.0:.0f} min'
        return f'{wish}: {knowledge.trouble}' if knowledge.trouble else wish
    if knowledge.looked_up < settings.least_looked_up and patient:
        return (
            f'until {100 * settings.least_looked_up:.0f} % of the manoeuvres are computed; '
            f'{100 * knowledge.looked_up:.0f} % are'
        )
    return ''


def choose(
    proposals: Sequence[Proposal],
    settings: TrialSettings,
    *,
    here: TrialTarget,
    towed: Sequence[TowedState],
    struck: Sequence[TrialTarget],
    minutes_left: float,
    seabed: float = math.inf,
) -> Choice:
    """Choose the first proposal that passes no limit.

    Parameters
    ----------
    proposals
        Ranked, the best one first.
    settings
        Limits of tension, depth and distance from the seabed.
    here
        Present state, which would give no new information.
    towed, struck
        States that were towed, and targets that were struck off.
    minutes_left
        Remaining time of the trial, min.
    seabed
        Depth (m) of the water here.
    """
    refused: Counter[str] = Counter()
    for proposal in proposals:
        reason = _objection(proposal, settings, here, towed, struck, seabed)
        if not reason and proposal.minutes > minutes_left:
            reason = 'time'
        if not reason:
            return Choice(proposal, refused)
        refused[reason] += 1
    return Choice(None, refused)


def _objection(
    proposal: Proposal,
    settings: TrialSettings,
    here: TrialTarget,
    towed: Sequence[TowedState],
    struck: Sequence[TrialTarget],
    seabed: float,
) -> str:
    target = proposal.target
    visits = sum(target.near(state.target) for state in towed)
    objections = {
        'teaches nothing': not proposal.rate > 0.0,
        'here already': target.near(here),
        'struck off': any(target.near(other) for other in struck),
        'towed before': visits >= MAX_VISITS,
        'speed': not settings.least_speed - 1e-6 <= target.speed <= settings.most_speed + 1e-6,
        'tension': proposal.tension > settings.max_tension,
        'depth': proposal.deepest > settings.max_depth,
        'seabed': proposal.deepest + settings.clearance > min(seabed, settings.seabed),
    }
    return next((reason for reason, is_so in objections.items() if is_so), '')
