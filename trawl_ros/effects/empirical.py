# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Empirical terms for what no effect of the catalogue explains.

Terms act on one object each: force on the boards, force on ropes and net, or the reading of a
sensor. What both boards have in common and what does not change with time is part of their
coefficients already, so board terms are differences between the sides, and drifts.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Effect, Parameter, Readings, Situation
from trawl_ros.model.hooks import CoefficientModifier
from trawl_ros.model.numerics import dot
from trawl_ros.records.channels import CHANNELS, MEASURED

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

DIRECTIONS = ('ahead', 'outward', 'up')
HALF_DIFFERENCE = np.array([0.5, -0.5])
BOTH_BOARDS = np.array([1.0, 1.0])

SENSOR_ERRORS = {
    'offset': ('shows too much or too little, by a constant amount', 'any tow'),
    'scale': ('has a scale error', 'what changes the channel'),
}
"""Kind of sensor error → words for it, and what excites it."""


@dataclass(frozen=True)
class EmpiricalTerm(Effect):
    """Empirical term: a force or sensor error of a form that is dimensionally sound and no more.

    Attributes
    ----------
    reading
        The nearest physical explanation, in words; never a fact.
    """

    reading: str = ''


@cache
def dictionary() -> Mapping[str, EmpiricalTerm]:
    """Return all empirical terms by name."""
    terms = (*board_terms(), *rope_terms(), *sensor_terms(), *profile_terms())
    return MappingProxyType({term.name: term for term in terms})


def size(unit: str, std: float, bound: float) -> tuple[Parameter, ...]:
    """Return the parameter of a term: one number, 0 where the term is absent, of either sign.

    ``std`` and ``bound`` are assumed: they scale and bound the search.
    """
    return (Parameter('size', unit, 0.0, -bound, bound, std),)


@dataclass(frozen=True)
class CoefficientIncrement:
    """Coefficient modifier: adds to one force coefficient of both boards (2,), after any other."""

    place: int
    sizes: FloatArray
    before: CoefficientModifier | None

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Return the coefficients with the addition."""
        # The zero gives the coefficients the shape and the kind (real or complex) of the angles.
        modified = coefficients + 0.0 * attack[..., None]
        if self.before is not None:
            modified = self.before(modified, attack, slip, lean)
        more = np.zeros((2, coefficients.shape[-1]))
        more[:, self.place] = self.sizes
        return modified + more


@dataclass(frozen=True)
class BoardForce(EmpiricalTerm):
    """Force on the boards as a share of ½ρU²A: difference of the sides, or drift per hour."""

    place: int = 0
    by_hours: bool = False

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with the force on its boards."""
        sizes = values[0] * (at.hours * BOTH_BOARDS if self.by_hours else HALF_DIFFERENCE)
        return model.with_board(
            coefficient_modifier=CoefficientIncrement(
                self.place, sizes, model.board.coefficient_modifier
            )
        )


def board_terms() -> Iterator[EmpiricalTerm]:
    """Yield all terms of force on the boards."""
    for place, direction in enumerate(DIRECTIONS):
        yield BoardForce(
            name=f'empirical_boards_{direction}_difference',
            sentence=f'More force {direction} on the port board than on the starboard board.',
            parameters=size('of ½ρU²A', 0.1, 2.0),
            excited_by='any tow',
            reading='one board is bent, worn, fouled or rigged unlike the other',
            place=place,
        )
        yield BoardForce(
            name=f'empirical_boards_{direction}_with_time',
            sentence=f'Force {direction} on both boards that grows with the time in the tow.',
            parameters=size('of ½ρU²A per h', 0.1, 1.0),
            excited_by='time in the tow',
            reading='boards that fill with mud, or shift in their rigging, while towing',
            place=place,
            by_hours=True,
        )


@dataclass(frozen=True)
class BridleDrag(EmpiricalTerm):
    """Normal drag of the bridles: of both sides, or more at starboard and less at port."""

    difference: bool = False

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with changed drag of the bridles."""
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
        """Return the gear model with changed friction of the warps."""
        factor = np.where(model.warp_side >= 0, 1.0 + values[0], 1.0)
        bars = replace(model.bars, friction=factor * model.bars.friction)
        return replace(model, bars=bars)


@dataclass(frozen=True)
class NetWeight(EmpiricalTerm):
    """Weight of the net in water."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with changed weight of the net."""
        return model.with_net(1.0, 1.0 + values[0])


@dataclass(frozen=True)
class QuadraticLift:
    """Node force: lift that goes with the square of the speed, ½ρU² times an area."""

    nodes: IntArray
    factor: float

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the lift on the nodes (k, 3), N."""
        upward = np.array([0.0, 0.0, 1.0])
        lift: FloatArray = self.factor * dot(velocities, velocities)[..., None] * upward
        return lift


@dataclass(frozen=True)
class HeadropeLift(EmpiricalTerm):
    """Lift on the middle of the headrope."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with changed lift of the headrope."""
        head = model.layout.headrope
        factor = 0.5 * model.water.density * values[0]
        lift = QuadraticLift(np.array([head[len(head) // 2]]), factor)
        return replace(model, node_forces=(*model.node_forces, lift))


@dataclass(frozen=True)
class TideAlong(EmpiricalTerm):
    """Tidal current along the track that changes with time."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the warp lengths, and the speed through the water with the tide."""
        true: FloatArray = inputs + np.array([0.0, 0.0, values[0] * at.hours])
        return true


@dataclass(frozen=True)
class WarpWithTime(EmpiricalTerm):
    """Drift of both counters per hour: warp paid out in excess of the length shown."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return the warp lengths with the drift, and the speed."""
        true: FloatArray = inputs + np.array([1.0, 1.0, 0.0]) * values[0] * at.hours
        return true


def rope_terms() -> Iterator[EmpiricalTerm]:
    """Yield all terms of force on ropes and net, and of speed and warp that drift."""
    yield BridleDrag(
        name='empirical_bridles_drag',
        sentence='Additional normal drag of all bridles, as a part of their drag.',
        parameters=size('', 0.5, 20.0),
        excited_by='any tow',
        reading='bridles that are fouled or vibrate',
    )
    yield BridleDrag(
        name='empirical_bridles_drag_difference',
        sentence='More normal drag of the starboard bridles than of the port bridles.',
        parameters=size('', 0.5, 20.0),
        excited_by='any tow',
        reading='bridles of one side that are fouled',
        difference=True,
    )
    yield WarpFriction(
        name='empirical_warps_friction',
        sentence='Additional tangential drag of the warps, as a part of their drag.',
        parameters=size('', 1.0, 50.0),
        excited_by='warp length',
        reading='rough, fouled or frayed warps',
    )
    yield NetWeight(
        name='empirical_net_weight',
        sentence='Additional weight of the net in water, as a part of its weight.',
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
        sentence='Speed through the water in excess of the log that grows with the time in the '
        'tow.',
        parameters=size('m/s per h', 0.05, 0.6),
        excited_by='time in the tow',
        reading='a current below the log that sets in, or a log that drifts',
    )
    yield WarpWithTime(
        name='empirical_warps_with_time',
        sentence='Warp paid out in excess of the counters that grows with the time in the tow.',
        parameters=size('m per h', 5.0, 60.0),
        excited_by='time in the tow',
        reading='counters that slip, or warps that creep through the brakes',
    )


@dataclass(frozen=True)
class SensorError(EmpiricalTerm):
    """Error of one channel: its reading minus the observable."""

    channel: str = ''
    by: str = ''

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Return the readings with the channel's error."""
        (value,), there = values, readings[self.channel]
        error = value * there if self.by == 'scale' else value
        return readings | {self.channel: there + error}


def sensor_terms() -> Iterator[EmpiricalTerm]:
    """Yield all sensor terms: two of each channel."""
    for name in MEASURED:
        channel = CHANNELS[name]
        usual = usual_error(name)
        words = name.replace('_', ' ')
        for by, (reading, excited_by) in SENSOR_ERRORS.items():
            unit, std = ('', 0.05) if by == 'scale' else (channel.unit, usual)
            yield SensorError(
                name=f'empirical_{name}_{by}',
                sentence=f'The sensor of {words} {reading}.',
                parameters=size(unit, std, 20.0 * std),
                excited_by=excited_by,
                reading=f'a sensor of {words} that {reading}',
                channel=name,
                by=by,
            )


PROFILE_DEPTHS_M = (50.0, 150.0, 300.0)
"""Depths of the knots of a current profile; it is zero at the surface and constant below them."""


@dataclass(frozen=True)
class CurrentProfile(EmpiricalTerm):
    """Current of any profile in depth, piecewise linear between knots, along or across the track.

    ``along`` is True for a current along the track, False for one to the left of it.
    """

    along: bool = True

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model in the current."""
        way = at.along if self.along else at.across
        currents = np.concatenate(([0.0], values))[:, None] * way
        depths = np.array([0.0, *PROFILE_DEPTHS_M])
        return replace(model, water=model.water.with_more_current(depths, currents))


def profile_terms() -> Iterator[EmpiricalTerm]:
    """Yield currents of any profile in depth."""
    for name, words, along in (('along', 'along', True), ('across', 'to the left of', False)):
        yield CurrentProfile(
            name=f'current_profile_{name}',
            sentence=f'The water moves {words} the track, differently at each depth.',
            parameters=tuple(
                Parameter(f'at_{depth:.0f}_m', 'm/s', 0.0, -0.8, 0.8, 0.1)
                for depth in PROFILE_DEPTHS_M
            ),
            excited_by='warp length; reciprocal tracks reverse it',
            reading=f'a current {words} the track that differs with depth',
            along=along,
        )


def usual_error(name: str) -> float:
    """Return the common error of a channel, a standard deviation, SI; assumed."""
    return 0.05 if CHANNELS[name].unit == 'rad' else 0.02 * _typical(name)


def _typical(name: str) -> float:
    """Return the typical size of a channel, SI."""
    if name.endswith('tension'):
        return 80e3
    return 50.0 if name in ('door_spread', 'vertical_opening') else 150.0
