# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of the planner's advice into proposals for the controller of an autonomous survey."""

from trawl_ros.control.trial.records import Knowledge, Proposal, TrialTarget
from trawl_ros.estimation.fit.laws import QUANTITIES
from trawl_ros.estimation.planning.advice import Advice, RankedManoeuvre


def knowledge_of(advice: Advice | None, windows: int) -> Knowledge:
    """Return the knowledge record of an estimator.

    Parameters
    ----------
    advice
        Newest advice on the next manoeuvre; None before the first.
    windows
        Number of windows that the estimator has used. The advice may be based on fewer.
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
        target=TrialTarget(
            port=manoeuvre.port_length,
            starboard=manoeuvre.starboard_length,
            speed=manoeuvre.speed,
        ),
        minutes=ranked.minutes,
        nats=ranked.nats,
        rate=ranked.rate,
        tension=ranked.tension,
        deepest=ranked.deepest,
    )
