# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Planned trials: their steady states, courses and times."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from trawl_ros.effects.base.effect import Situation

State = tuple[float, float]
"""Warp length (m) and speed (m/s) as counters and log show them."""

HOURS_APART = 0.5
FIRST_HOURS = 0.4
"""Time of the first state in a tow; another one follows every half hour."""

_ONE: tuple[State, ...] = ((300.0, 2.4), (550.0, 2.0), (800.0, 2.2), (450.0, 2.4), (550.0, 2.2))
_TWO: tuple[State, ...] = ((450.0, 2.0), (300.0, 2.2), (650.0, 2.4), (900.0, 2.2), (450.0, 2.2))
_THREE: tuple[State, ...] = ((650.0, 2.0), (900.0, 2.4), (300.0, 2.0), (550.0, 2.4), (650.0, 2.2))


@dataclass(frozen=True)
class PlannedTow:
    """Planned tow: steady states one after another; ``eastward`` or on the reciprocal track."""

    states: tuple[State, ...]
    eastward: bool

    @property
    def sense(self) -> float:
        """1 eastward, -1 on the reciprocal track."""
        return 1.0 if self.eastward else -1.0

    def moment(self, place: int) -> Situation:
        """Situation of the state at a place."""
        length, speed = self.states[place]
        return Situation(
            (length, length, speed),
            sense=self.sense,
            hours=FIRST_HOURS + HOURS_APART * place,
        )


@dataclass(frozen=True)
class BlindTrialPlan:
    """Planned trial: tows, of which the first ``baseline`` are from when the gear was in order."""

    tows: tuple[PlannedTow, ...]
    baseline: int


FULL_PLAN = BlindTrialPlan(
    tuple(
        PlannedTow(states, eastward=number % 2 == 0)
        for number, states in enumerate((_ONE, _TWO, _THREE, _ONE, _TWO, _THREE, _ONE, _TWO))
    ),
    baseline=2,
)
"""Plan with two courses, in which each state comes early in one tow and late in another."""

_FISHING: tuple[State, ...] = ((450.0, 2.2), (650.0, 2.4), (650.0, 2.0))
_DEEPER: tuple[State, ...] = ((550.0, 2.4), (800.0, 2.2), (450.0, 2.0))

DAY_PLAN = BlindTrialPlan(
    (
        PlannedTow(_FISHING, True), PlannedTow(_DEEPER, False),
        PlannedTow(_FISHING, True), PlannedTow(_DEEPER, False),
    ),
    baseline=1,
)  # fmt: skip
"""Plan of one baseline and three tows of an hour, three states each."""

PLANS: Mapping[str, BlindTrialPlan] = {'full': FULL_PLAN, 'day': DAY_PLAN}

STATES = tuple(
    sorted({state for plan in PLANS.values() for tow in plan.tows for state in tow.states})
)


def nearest(state: State, known: tuple[State, ...]) -> State:
    """Return the state most similar to another one."""
    away = [abs(other[0] / state[0] - 1.0) + abs(other[1] / state[1] - 1.0) for other in known]
    return known[int(np.argmin(away))]
