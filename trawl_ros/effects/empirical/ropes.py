"""Empirical terms of force on warps, bridles and net, as shares of the present forces."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.effects.base.term import EmpiricalTerm, size
from trawl_ros.model.numerics import dot

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel


@dataclass(frozen=True)
class BridleDrag(EmpiricalTerm):
    """Normal drag of the bridles of both sides, or of starboard against port."""

    difference: bool = False

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with changed drag of the bridles."""
        port, starboard = (
            np.isin(model.ends, np.concatenate(pair)).any(axis=1)
            for pair in model.layout.bridles_by_side
        )
        more = np.where(starboard, values[0], 0.0)
        more = more + np.where(port, -values[0] if self.difference else values[0], 0.0)
        bars = model.bars
        drag = bars.normal_drag + more * np.where(port | starboard, bars.normal_drag, 0.0)
        return replace(model, bars=replace(bars, normal_drag=drag))


@dataclass(frozen=True)
class WarpFriction(EmpiricalTerm):
    """Tangential drag of the warps."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with changed friction of the warps."""
        factor = np.where(model.warp_side >= 0, 1.0 + values[0], 1.0)
        bars = replace(model.bars, friction=factor * model.bars.friction)
        return replace(model, bars=bars)


@dataclass(frozen=True)
class NetWeight(EmpiricalTerm):
    """Weight of the net in water."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with changed weight of the net."""
        return model.with_net(1.0, 1.0 + values[0])


@dataclass(frozen=True)
class Lifted:
    """Node force: lift that goes with the square of the speed, ½ρU² times an area."""

    nodes: IntArray
    factor: float

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Lift on the nodes (k, 3), N."""
        upward = np.array([0.0, 0.0, 1.0])
        lift: FloatArray = self.factor * dot(velocities, velocities)[..., None] * upward
        return lift


@dataclass(frozen=True)
class HeadropeLift(EmpiricalTerm):
    """Lift on the middle of the headrope."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Gear model with changed lift of the headrope."""
        head = model.layout.headrope
        factor = 0.5 * model.water.density * values[0]
        lifted = Lifted(np.array([head[len(head) // 2]]), factor)
        return replace(model, node_forces=(*model.node_forces, lifted))


@dataclass(frozen=True)
class TideAlong(EmpiricalTerm):
    """Tidal current along the track that changes with time."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Warp lengths, and the speed through the water with the tide."""
        true: FloatArray = inputs + np.array([0.0, 0.0, values[0] * at.hours])
        return true


@dataclass(frozen=True)
class WarpWithTime(EmpiricalTerm):
    """Drift of both counters per hour: warp out beside the length shown."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Warp lengths with the drift, and the speed."""
        true: FloatArray = inputs + np.array([1.0, 1.0, 0.0]) * values[0] * at.hours
        return true


def rope_terms() -> Iterator[EmpiricalTerm]:
    """Yield all terms of force on ropes and net."""
    yield BridleDrag(
        name='empirical_bridles_drag',
        sentence='Drag across all bridles, as a part of what they have.',
        parameters=size('', 0.5, 20.0),
        excited_by='any tow',
        reading='bridles that are fouled or vibrate',
    )
    yield BridleDrag(
        name='empirical_bridles_drag_difference',
        sentence='Drag across the starboard bridles more than across those of port.',
        parameters=size('', 0.5, 20.0),
        excited_by='any tow',
        reading='bridles of one side that are fouled',
        difference=True,
    )
    yield WarpFriction(
        name='empirical_warps_friction',
        sentence='Drag along the warps, as a part of what they have.',
        parameters=size('', 1.0, 50.0),
        excited_by='warp length',
        reading='rough, fouled or frayed warps',
    )
    yield NetWeight(
        name='empirical_net_weight',
        sentence='Weight of the net in water, as a part of what it has.',
        parameters=size('', 0.2, 3.0),
        excited_by='low speed',
        reading='sand or mud in the net, wet or lost floats',
    )
    yield HeadropeLift(
        name='empirical_headrope_lift',
        sentence='Lift at the middle of the headrope that goes with the square of the speed.',
        parameters=size('m²', 1.0, 20.0),
        excited_by='speed',
        reading='a kite that is torn or set unlike its drawing',
    )
    yield TideAlong(
        name='empirical_water_with_time',
        sentence='Speed through the water beside the log that grows with the time in the tow.',
        parameters=size('m/s per h', 0.05, 0.6),
        excited_by='time in the tow',
        reading='a current below the log that sets in, or a log that drifts',
    )
    yield WarpWithTime(
        name='empirical_warps_with_time',
        sentence='Warp beside what the counters show that grows with the time in the tow.',
        parameters=size('m per h', 5.0, 60.0),
        excited_by='time in the tow',
        reading='counters that slip, or warps that creep through the brakes',
    )
