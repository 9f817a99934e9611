"""Lift of the boards by their tilt."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.model.hooks import LIFT

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class Tilted:
    """Coefficient modifier: lift that grows, linearly, as the outer face looks up."""

    slope: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Multiply C_y^F by the factor of the tilt."""
        bent = coefficients + 0.0 * lean[..., None]
        bent[..., LIFT] = bent[..., LIFT] * (1.0 + self.slope * lean)
        return bent


class TiltLift(Effect):
    """Lift by the boards' tilt."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with boards whose lift depends on their tilt."""
        return model.with_modifier(Tilted(float(values[0])))


EFFECT = TiltLift(
    name='tilt_lift',
    sentence="The boards' lift changes as they lean inward or outward.",
    parameters=(Parameter('slope', '1/rad', 0.0, -2.0, 2.0, 0.5),),
    excited_by='what makes the boards lean: warp length and speed',
    confused_with=('warp_strumming',),
    direct='Compare the roll of both doors with the marks of wear on their shoes.',
    causes='boards that lean in or out with long or short warps, bridles of unequal length.',
)
