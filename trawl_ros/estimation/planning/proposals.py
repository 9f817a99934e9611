# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Proposals for a trial that runs itself, from the advice on the next manoeuvre."""

from trawl_ros.control.trial.records import Knowledge, Proposal, TrialTarget
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.planning.advice import Advice, RankedManoeuvre


def knowledge_of(advice: Advice | None, windows: int) -> Knowledge:
    """Return what an estimator that has used so many windows knows.

    Parameters
    ----------
    advice
        None before there is any.
    windows
        Number of windows used, which the advice may lag behind.
    """
    if advice is None:
        return Knowledge(windows=windows)
    return Knowledge(
        windows=windows,
        ratios=dict(zip(QUANTITIES, map(float, advice.before.ratio), strict=True)),
        advised=advice.windows,
        looked_up=advice.looked_up,
        proposals=tuple(map(_proposal, advice.ranking)),
    )


def _proposal(ranked: RankedManoeuvre) -> Proposal:
    manoeuvre = ranked.manoeuvre
    return Proposal(
        TrialTarget(
            port=manoeuvre.port_length,
            starboard=manoeuvre.starboard_length,
            speed=manoeuvre.speed,
        ),
        ranked.minutes,
        ranked.nats,
        ranked.rate,
        ranked.tension,
        ranked.deepest,
    )
