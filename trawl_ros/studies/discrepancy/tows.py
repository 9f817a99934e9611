"""The planned trial: which steady states are towed, on which course, and when."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.effects.effect import Situation

State = tuple[float, float]
"""Warp length (m) and speed (m/s) as counters and log show them."""

BASELINE = 2
"""So many tows are of when the gear was in order."""

HOURS_APART = 0.5
FIRST_HOURS = 0.4
"""Into the tow the first state is reached, and another after each half hour."""

_ONE: tuple[State, ...] = ((300.0, 2.4), (550.0, 2.0), (800.0, 2.2), (450.0, 2.4), (550.0, 2.2))
_TWO: tuple[State, ...] = ((450.0, 2.0), (300.0, 2.2), (650.0, 2.4), (900.0, 2.2), (450.0, 2.2))
_THREE: tuple[State, ...] = ((650.0, 2.0), (900.0, 2.4), (300.0, 2.0), (550.0, 2.4), (650.0, 2.2))


@dataclass(frozen=True)
class PlannedTow:
    """Steady states one after another; ``eastward`` or on the reciprocal track."""

    states: tuple[State, ...]
    eastward: bool

    def moment(self, place: int) -> Situation:
        """When and how the state at a place is towed."""
        length, speed = self.states[place]
        return Situation(
            (length, length, speed),
            sense=1.0 if self.eastward else -1.0,
            hours=FIRST_HOURS + HOURS_APART * place,
        )


PLAN = tuple(
    PlannedTow(states, eastward=number % 2 == 0)
    for number, states in enumerate((_ONE, _TWO, _THREE, _ONE, _TWO, _THREE, _ONE, _TWO))
)
"""The first of them are the `BASELINE`; the states of a tow come early in one and late in another,
on both courses."""

STATES = tuple(sorted({state for tow in PLAN for state in tow.states}))


def nearest(state: State, known: tuple[State, ...]) -> State:
    """The state most like another."""
    away = [abs(other[0] / state[0] - 1.0) + abs(other[1] / state[1] - 1.0) for other in known]
    return known[int(np.argmin(away))]
