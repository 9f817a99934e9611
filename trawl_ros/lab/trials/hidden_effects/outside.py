# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hidden effects that the catalogue does not have."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden, Readings
from trawl_ros.lab.trials.hidden_effects.inside import CABLES, USUAL_LENGTH, Draw
from trawl_ros.model.gear_model import GearModel

USUAL_ATTACK = 0.3


@dataclass(frozen=True)
class MoreLoad:
    """Coefficient modifier of both boards (``side`` None) or one board, by a power of attack."""

    size: float
    place: int
    power: float
    side: int | None = None

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Add to the coefficient."""
        bent = coefficients + 0.0 * attack[..., None]
        more = self.size * (attack / USUAL_ATTACK) ** self.power
        if self.side is None:
            bent[..., self.place] += more
        else:
            bent[..., self.side, self.place] += more[..., self.side]
        return bent


def net_weight(rng: np.random.Generator) -> Hidden:
    """Sand, mud or water-logged floats in the net."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_net(1.0, 1.0 + size)

    return Hidden('net_weight', '', 0.3, (0.8, 4.0), gear=gear)


def jet(rng: np.random.Generator) -> Hidden:
    """Layer of the sea that moves along the track."""
    middle, width = rng.uniform(90.0, 150.0), rng.uniform(25.0, 40.0)
    depths = np.linspace(0.0, 400.0, 41)
    profile = np.exp(-0.5 * ((depths - middle) / width) ** 2)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        currents = size * profile[:, None] * at.along
        return replace(model, water=model.water.with_more_current(depths, currents))

    return Hidden('jet', 'm/s', 0.1, (0.8, 0.8), gear=gear)


def bridle_weed(rng: np.random.Generator) -> Hidden:
    """Weed on the bridles of one side."""

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        nodes = np.concatenate(model.layout.bridles_by_side[1])
        on = np.isin(model.ends, nodes).any(axis=1)
        drag = model.bars.normal_drag * np.where(on, 1.0 + size, 1.0)
        friction = model.bars.friction * np.where(on, 1.0 + 10.0 * size, 1.0)
        bars = replace(model.bars, normal_drag=drag, friction=friction)
        return replace(model, bars=bars)

    return Hidden('bridle_weed', '', 1.0, (0.0, 20.0), gear=gear)


def block_angle(rng: np.random.Generator) -> Hidden:
    """Load cells in blocks that hang at another angle on short warps than at calibration."""
    power = rng.uniform(0.7, 1.3)

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        steeper = (USUAL_LENGTH / at.inputs[0]) ** power - 1.0
        return readings | {name: readings[name] * (1.0 + size * steeper) for name in CABLES}

    return Hidden('block_angle', '', 0.1, (0.5, 0.5), shown=shown)


def counter_drift(rng: np.random.Generator) -> Hidden:
    """Counters that lose a little at each haul, and so drift during the tow."""

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        return np.array([*(inputs[:2] - size * (at.hours - 1.4)), inputs[2]])

    return Hidden('counter_drift', 'm per h', 10.0, (60.0, 60.0), towed=towed)


def port_depth_sensor(rng: np.random.Generator) -> Hidden:
    """Depth sensor of one board with an error that grows with depth."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        depth = readings['port_door_depth']
        return readings | {'port_door_depth': depth * (1.0 + size)}

    return Hidden('port_depth_sensor', '', 0.03, (0.3, 0.3), shown=shown)


def starboard_cell(rng: np.random.Generator) -> Hidden:
    """Wrong load cell on one side."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        return readings | {CABLES[1]: readings[CABLES[1]] * (1.0 + size)}

    return Hidden('starboard_cell', '', 0.1, (0.5, 0.5), shown=shown)


def pitch_mount(rng: np.random.Generator) -> Hidden:
    """Attitude sensors mounted askew that also turn in their clamps."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        error = size * at.hours
        names = ('port_pitch', 'starboard_pitch')
        return readings | {name: readings[name] + error for name in names}

    return Hidden('pitch_mount', 'rad per h', 0.02, (0.3, 0.3), shown=shown)


def opening_by_depth(rng: np.random.Generator) -> Hidden:
    """Sonar whose picture of the opening is stretched with depth."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        opening = readings['vertical_opening']
        stretched = opening * (1.0 + size * (readings['net_depth'] / 100.0 - 1.5))
        return readings | {'vertical_opening': stretched}

    return Hidden('opening_by_depth', 'per 100 m', 0.1, (0.6, 0.6), shown=shown)


def spread_by_hours(rng: np.random.Generator) -> Hidden:
    """Spread sensor whose clock drifts."""

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        return readings | {'door_spread': readings['door_spread'] + size * (at.hours - 0.9)}

    return Hidden('spread_by_hours', 'm per h', 2.0, (30.0, 30.0), shown=shown)


OUTSIDE: Mapping[str, Draw] = {
    draw.__name__: draw
    for draw in (
        block_angle, bridle_weed, counter_drift, jet, net_weight, opening_by_depth, pitch_mount,
        port_depth_sensor, spread_by_hours, starboard_cell,
    )
}  # fmt: skip
"""Ten kinds."""
