"""Currents that change while one tows: along the track, or with time."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

ABOVE, BELOW = 5.0, 30.0
"""The log looks into the water above the first depth (m); below the second the current is whole."""

TURNS = (1.0, 2.5)
"""Hours into the tow, from which the search for the turn of the current begins."""


@dataclass(frozen=True)
class ChangingCurrent(Effect):
    """Current below the log that grows with the hours in the tow, and turns at one of them.

    What changes from place to place is met the other way round on the reciprocal track, and comes
    from the other end there: for the ship it is the same (``in_place``). What changes with time is
    not.
    """

    in_place: bool = True

    def starts(self, depths: FloatArray) -> tuple[FloatArray, ...]:
        """Start values: the current may turn early or late."""
        return tuple(np.array([0.0, turn]) for turn in TURNS)

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model in the current of the situation's hours."""
        rate, turn = values
        ahead = at.sense * at.along if self.in_place else at.along
        below = rate * (at.hours - turn) * ahead
        water = model.water.with_more_current(
            np.array([0.0, ABOVE, BELOW]), np.stack([np.zeros(2), np.zeros(2), below])
        )
        return replace(model, water=water)


def _changing(name: str, sentence: str, causes: str, *, in_place: bool) -> ChangingCurrent:
    return ChangingCurrent(
        name=name,
        sentence=sentence,
        parameters=(
            Parameter('rate', 'm/s per h', 0.0, -0.5, 0.5, 0.05),
            Parameter('turn', 'h', 0.0, -6.0, 12.0, 2.0),
        ),
        excited_by='time in the tow; the same warp length and speed early and late',
        confused_with=('catch_build_up', 'speed_log', 'current_shear'),
        direct='Compare the log with a current profiler or with speed over ground at the beginning '
        'and at the end of a tow, and look up the tide.',
        causes=causes,
        in_place=in_place,
    )


EFFECTS = (
    _changing(
        'current_along_track',
        'The current below the log changes along the track, the same in each tow.',
        'the edge of a current, an eddy, a slope or a bank beside which the water runs faster.',
        in_place=True,
    ),
    _changing(
        'current_in_time',
        'The current below the log changes while one tows, as a tide does.',
        'a tide that sets in or turns during the tow.',
        in_place=False,
    ),
)
