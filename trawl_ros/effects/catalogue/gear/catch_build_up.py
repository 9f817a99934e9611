"""Catch build-up: drag of the codend that grows during a tow."""

from dataclasses import replace
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


class CatchBuildUp(Effect):
    """Drag of the codend's end that grows with the time in the tow."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with the catch of the situation's hours."""
        area = model.lump_drag_area.copy()
        area[_codend(model)] += values[0] * at.hours
        return replace(model, lump_drag_area=area)


def _codend(model: 'GearModel') -> int:
    """Number of the last node of the codend."""
    ends = [points[-1] for name, points, _ in model.layout.lines if name == 'codend']
    return int(ends[-1])


EFFECT = CatchBuildUp(
    name='catch_build_up',
    sentence='The catch fills the codend, whose drag grows while one tows.',
    parameters=(Parameter('drag_area', 'm² per h', 0.0, 0.0, 20.0, 3.0),),
    excited_by='time in the tow; the same warp length and speed early and late',
    confused_with=('net_drag', 'depth_sensor'),
    direct='Weigh what comes up, and read the catch sensors.',
    causes='fish, jellyfish or mud in the codend.',
)
