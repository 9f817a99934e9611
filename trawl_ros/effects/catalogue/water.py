# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Effects of the water: currents, leeway, sea and ground."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Effect, Parameter, Situation
from trawl_ros.model.numerics import length

if TYPE_CHECKING:
    from trawl_ros.model.gear_model import GearModel

SURFACE_LAYER_M = (20.0, 60.0)
"""Depths between which a cross-current grows from nothing to its full size."""

LOG_LAYER_M = (5.0, 30.0)
"""Depths between which a changing current grows from nothing to its full size.

The log measures the water above the first of them.
"""

LEEWAY_DEPTH_M = 5.0
"""Depth below which the water passes askew; the towing blocks go with the water at the surface."""

SHEAR_DEPTH_STEP_M = 100.0
"""Depth over which a shear is stated."""

SHEAR_END_M = 2000.0
"""Depth below which a sheared current stays constant."""

GROUND_ROUNDING_M = 4.0
"""Range of depth over which the ground takes hold of a weight."""

FRICTION_ROUNDING_M_S = 0.1
"""Speed above which friction on the ground has its full size."""

SEABED_MARGIN_M, SEABED_MARGIN_FRACTION = 15.0, 0.05
"""The seabed may lie higher under the gear than under the ship by this depth and this fraction."""

GROUND_START_QUANTILES = (0.5, 0.6, 0.7, 0.8, 0.9)
"""Quantiles of the wing tips' depths at which a search for the ground begins."""


def _with_deep_current(
    model: 'GearModel', depths: tuple[float, ...], current: FloatArray
) -> 'GearModel':
    """Add a current (2,) below the last of the depths (m); there is none above the others."""
    levels = np.zeros((len(depths) + 1, 2))
    levels[-1] = current
    return replace(model, water=model.water.with_more_current(np.array([0.0, *depths]), levels))


@dataclass(frozen=True)
class Ground:
    """Ground force on nodes below a depth: friction and a vertical reaction of the same size."""

    nodes: IntArray
    depth: float
    friction: float

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return friction against the velocity over ground with an equal upward reaction, N."""
        below = (-positions[..., 2] - self.depth) / GROUND_ROUNDING_M
        hold = 0.5 * self.friction * (1.0 + np.tanh(0.5 * below))
        upward = np.array([0.0, 0.0, 1.0])
        forces: FloatArray = hold[..., None] * (
            upward - velocities / length(velocities, FRICTION_ROUNDING_M_S)[..., None]
        )
        return forces


class BottomContact(Effect):
    """Ground contact of both lower wing tips below a depth."""

    def starts(self, depths: FloatArray) -> tuple[FloatArray, ...]:
        """Return start values: the ground may lie at any depth that the wing tips reached.

        A refit from one start may converge to a wrong depth of the ground.
        """
        return tuple(
            np.array([0.0, depth]) for depth in np.quantile(depths, GROUND_START_QUANTILES)
        )

    def is_possible(self, lowest: FloatArray, seabed: FloatArray) -> bool:
        """Return False if the echo sounder shows water under the net in all tows."""
        above = seabed * (1.0 - SEABED_MARGIN_FRACTION) - SEABED_MARGIN_M
        return not bool(np.all(lowest < above))

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model with ground under the wing tips."""
        friction, depth = map(float, values)
        foot = model.layout.footrope
        ground = Ground(np.array([foot[0], foot[-1]]), depth, friction)
        return replace(model, node_forces=(*model.node_forces, ground))


@dataclass(frozen=True)
class ChangingCurrent(Effect):
    """Current below the log that changes linearly with the hours in the tow, from a first one.

    A current that changes from place to place (``in_place``) is met in the reverse order on the
    reciprocal track, and from the other end: for the ship it is the same. A current that changes
    with time is not.
    """

    in_place: bool = True

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model in the current of the situation's hours."""
        rate, first = values
        ahead = at.sense * at.along if self.in_place else at.along
        return _with_deep_current(model, LOG_LAYER_M, (rate * at.hours + first) * ahead)


class CrossCurrent(Effect):
    """Current across the track, constant below the surface layer and zero in it."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model in a current to the left of the track."""
        return _with_deep_current(model, SURFACE_LAYER_M, values[0] * at.across)


class CurrentShear(Effect):
    """Current along the track, linear in depth and zero at the surface."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model in a sheared current along the track."""
        bottom = values[0] * SHEAR_END_M / SHEAR_DEPTH_STEP_M * at.along
        return _with_deep_current(model, (SHEAR_END_M,), bottom)


class HeaveEffect(Effect):
    """Increase of mean drag, which goes with the mean of the squared speed."""

    def apply_to_inputs(self, values: FloatArray, inputs: FloatArray, at: Situation) -> FloatArray:
        """Return both warp lengths and the root-mean-square speed through the water."""
        port, starboard, speed = inputs
        return np.array([port, starboard, np.sqrt(speed**2 + values[0])])


class Leeway(Effect):
    """Angle by which the ship's motion through the water lies to port of her heading."""

    def gear(self, values: FloatArray, model: 'GearModel', at: Situation) -> 'GearModel':
        """Return the gear model in water that passes the ship askew, on either course."""
        aside = at.speed * np.tan(values[0])
        current = aside * np.array([np.sin(at.heading), -np.cos(at.heading)])
        return _with_deep_current(model, (LEEWAY_DEPTH_M,), current)


def _changing(name: str, sentence: str, causes: str, *, in_place: bool) -> ChangingCurrent:
    return ChangingCurrent(
        name=name,
        sentence=sentence,
        parameters=(
            Parameter('rate', 'm/s per h', 0.0, -0.5, 0.5, 0.05),
            Parameter('first', 'm/s', 0.0, -0.8, 0.8, 0.1, strength=False),
        ),
        excited_by='time in the tow; the same warp length and speed early and late',
        confused_with=('catch_build_up', 'speed_log', 'current_shear'),
        direct='Compare the log with a current profiler or with speed over ground at the beginning '
        'and at the end of a tow, and look up the tide.',
        causes=causes,
        in_place=in_place,
    )


EFFECTS = (
    BottomContact(
        name='bottom_contact',
        sentence='Below a depth the lower wing tips drag over the bottom.',
        parameters=(
            Parameter('friction', 'N', 0.0, 0.0, 10e3, 2e3),
            Parameter('depth', 'm', 0.0, 0.0, 2000.0, 50.0, strength=False),
        ),
        excited_by='depth near the bottom',
        confused_with=('net_drag', 'gear_weight'),
        direct='Look at the footrope and the clumps for mud and bright chain, and at the echo '
        'sounder for the depth where she towed.',
        causes='a net that was lowered too far, a bank or a slope, a wreck.',
    ),
    _changing(
        'current_along_track',
        'The current below the log changes along the track, the same in each tow.',
        'the edge of a current, an eddy, faster water along a slope or a bank.',
        in_place=True,
    ),
    _changing(
        'current_in_time',
        'The current below the log changes with time, as a tide does.',
        'a tide that sets in or turns during the tow.',
        in_place=False,
    ),
    CrossCurrent(
        name='cross_current',
        sentence="The water below the surface layer moves across the ship's track.",
        parameters=(Parameter('across', 'm/s', 0.0, -0.5, 0.5, 0.1),),
        excited_by='any tow; reciprocal tracks reverse it',
        confused_with=('warp_asymmetry',),
        direct='Look at a current profiler, or at a forecast of currents by depth.',
        causes='a current across the track below the surface layer.',
    ),
    CurrentShear(
        name='current_shear',
        sentence="The water moves along the ship's track, faster with depth.",
        parameters=(Parameter('along', 'm/s per 100 m', 0.0, -0.2, 0.2, 0.03),),
        excited_by='warp length and speed; reciprocal tracks reverse it',
        confused_with=('warp_strumming', 'counter_scale'),
        direct='Look at a current profiler, or at a forecast of currents by depth.',
        causes='a current that differs with depth, as below a thermocline or over a slope.',
    ),
    HeaveEffect(
        name='heave',
        sentence='Waves pull the gear to and fro, which adds to its mean drag.',
        parameters=(Parameter('variance', 'm²/s²', 0.0, 0.0, 1.5, 0.2),),
        excited_by='a sea; low speed shows it most',
        confused_with=('speed_log',),
        direct="Look up the sea state of the day, or the record of the ship's motion.",
        causes='a swell, a ship that surges on her warps.',
    ),
    Leeway(
        name='leeway',
        sentence='The ship moves through the water to one side of her heading.',
        parameters=(Parameter('angle', 'rad', 0.0, -0.3, 0.3, 0.05),),
        excited_by='any tow; the block of one side then lies ahead of the other',
        confused_with=('warp_asymmetry', 'cross_current'),
        direct='Compare the course made good in slack water with the heading, and look at the '
        'rudder.',
        causes='wind on the beam, rudder held to one side, one warp that pulls more.',
    ),
)
