"""Net drag: factor and exponent of speed."""

from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

USUAL_SPEED = 2.0
"""Speed (m/s) at which the factor is what it says."""

SLOWEST = 0.1
"""The power of speed ends here, m/s."""


class NetDrag(Effect):
    """Factor on the drag of netting and its ropes, and an exponent of speed beside the square."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with scaled drag of the net."""
        factor, exponent = values
        return model.with_net(factor * (max(at.speed, SLOWEST) / USUAL_SPEED) ** exponent, 1.0)


EFFECT = NetDrag(
    name='net_drag',
    sentence='The net is dirty, torn or not as drawn: its drag is another.',
    parameters=(
        Parameter('factor', '', 1.0, 0.5, 2.0, 0.15),
        Parameter('exponent', '', 0.0, -1.0, 1.0, 0.3),
    ),
    excited_by='any tow; the exponent by speed',
    confused_with=('speed_log', 'spread_sensor', 'catch_build_up'),
    direct='Look over the netting on deck: slime, weed, torn panels, another twine than drawn.',
    causes='slime or weed, meshed fish, torn panels, netting that was replaced by another twine.',
)
