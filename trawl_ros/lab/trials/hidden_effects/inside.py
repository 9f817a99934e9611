# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Hidden effects that the catalogue should name, in richer forms than its own.

Each function takes a random generator and returns an effect of a random shape.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.effects.base.effect import Situation
from trawl_ros.lab.trials.hidden_effects.hidden import Hidden, Readings, ahead
from trawl_ros.model.gear_model import GearModel

Draw = Callable[[np.random.Generator], Hidden]

CABLES = ('port_tension', 'starboard_tension')
DOORS = ('port_door_depth', 'starboard_door_depth')
DEPTHS = (*DOORS, 'net_depth')
USUAL_SPEED = 2.2
USUAL_LENGTH = 500.0


def current_shear(rng: np.random.Generator) -> Hidden:
    """Curved shear: a power of the depth."""
    power = rng.uniform(0.8, 1.3)
    depths = np.linspace(0.0, 800.0, 17)
    profile = 3.0 * (depths / 300.0) ** power

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        currents = size * profile[:, None] * at.along
        return replace(model, water=model.water.with_more_current(depths, currents))

    return Hidden('current_shear', 'm/s per 100 m', 0.02, (0.2, 0.2), gear=gear)


def cross_current(rng: np.random.Generator) -> Hidden:
    """Current across the track that begins at some depth and grows a little downward."""
    top, growth = rng.uniform(10.0, 40.0), rng.uniform(-0.1, 0.2)
    depths = np.array([0.0, top, top + 30.0, 500.0])
    profile = np.array([0.0, 0.0, 1.0, 1.0 + growth])

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        currents = size * profile[:, None] * at.across
        return replace(model, water=model.water.with_more_current(depths, currents))

    return Hidden('cross_current', 'm/s', 0.1, (0.5, 0.5), gear=gear)


def speed_log(rng: np.random.Generator) -> Hidden:
    """Speed log with a scale error that varies a little with the speed."""
    bend = rng.uniform(-0.3, 0.3)

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        port, starboard, speed = inputs
        scale = size * (1.0 + bend * (speed / USUAL_SPEED - 1.0))
        return np.array([port, starboard, speed / (1.0 + scale)])

    return Hidden('speed_log', '', 0.05, (0.25, 0.25), towed=towed)


def warp_strumming(rng: np.random.Generator) -> Hidden:
    """Strumming that varies with the Reynolds number and is strongest near the ship."""
    power, tilt = rng.uniform(-0.5, 0.5), rng.uniform(-0.2, 0.2)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        on = model.warp_side >= 0
        place = np.zeros(len(on))
        for side in (0, 1):
            bars = np.flatnonzero(model.warp_side == side)
            place[bars] = np.linspace(1.0, -1.0, len(bars))
        more = size * (at.speed / USUAL_SPEED) ** power * (1.0 + tilt * place)
        drag = model.bars.normal_drag * np.where(on, 1.0 + more, 1.0)
        return replace(model, bars=replace(model.bars, normal_drag=drag))

    return Hidden('warp_strumming', '', 0.3, (0.3, 1.5), gear=gear)


def counter_scale(rng: np.random.Generator) -> Hidden:
    """Counters that slip, more so with more warp and more tension."""
    bend = rng.uniform(-0.1, 0.2)

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        slip = size * (1.0 + bend * (inputs[:2] / USUAL_LENGTH - 1.0))
        return np.array([*(inputs[:2] / (1.0 + slip)), inputs[2]])

    return Hidden('counter_scale', '', 0.03, (0.15, 0.15), towed=towed)


def counter_offset(rng: np.random.Generator) -> Hidden:
    """Counters zeroed at another mark, with a small difference between the sides."""
    uneven = rng.uniform(-0.03, 0.03)

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        sides = size * np.array([1.0 + uneven, 1.0 - uneven])
        return np.array([*(inputs[:2] - sides), inputs[2]])

    return Hidden('counter_offset', 'm', 10.0, (50.0, 50.0), towed=towed)


def warp_asymmetry(rng: np.random.Generator) -> Hidden:
    """Longer port warp, with a difference that grows with the warp paid out."""
    bend = rng.uniform(-0.2, 0.2)

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        more = size * (1.0 + bend * (inputs[0] / USUAL_LENGTH - 1.0))
        return np.array([inputs[0] + 0.5 * more, inputs[1] - 0.5 * more, inputs[2]])

    return Hidden('warp_asymmetry', 'm', 3.0, (15.0, 15.0), towed=towed)


def catch_build_up(rng: np.random.Generator) -> Hidden:
    """Catch that arrives in steps."""
    steps = np.sort(rng.uniform(0.0, 2.8, 8))
    sizes = rng.gamma(2.0, size=8)
    sizes *= 2.8 / sizes.sum()

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        area = model.lump_drag_area.copy()
        end = [points[-1] for name, points, _ in model.layout.lines if name == 'codend'][-1]
        area[int(end)] += size * float(sizes[steps < at.hours].sum())
        return replace(model, lump_drag_area=area)

    return Hidden('catch_build_up', 'm² per h', 1.0, (0.0, 20.0), gear=gear)


def net_drag(rng: np.random.Generator) -> Hidden:
    """Fouled net whose drag grows with nearly the square of the speed, most in the belly."""
    power = rng.uniform(-0.1, 0.1)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_net(1.0 + size * (at.speed / USUAL_SPEED) ** power, 1.0)

    return Hidden('net_drag', '', 0.1, (0.5, 1.0), gear=gear)


@dataclass(frozen=True)
class Stalling:
    """Coefficient modifier: lift lost beyond an angle, with a power of the excess."""

    size: float
    onset: float
    power: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Subtract the lost lift."""
        above = np.where(np.real(attack) > self.onset, attack - self.onset, 1e-9)
        bent = coefficients + 0.0 * attack[..., None]
        # At 10° above the onset a size of 1 loses as much as it would with the square.
        bent[..., 1] -= self.size * 0.1745 ** (2.0 - self.power) * above**self.power
        return bent


def board_stall(rng: np.random.Generator) -> Hidden:
    """Stall at an angle and with a power that the catalogue does not have."""
    onset, power = np.radians(rng.uniform(14.0, 16.0)), rng.uniform(1.8, 2.2)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_board(coefficient_modifier=Stalling(size, onset, power))

    return Hidden('board_stall', '1/rad²', 2.0, (4.0, 12.0), gear=gear)


@dataclass(frozen=True)
class Leaning:
    """Coefficient modifier: lift changed by the lean, slightly non-linear."""

    size: float
    bend: float

    def __call__(
        self, coefficients: FloatArray, attack: FloatArray, slip: FloatArray, lean: FloatArray
    ) -> FloatArray:
        """Change the lift by the lean."""
        bent = coefficients + 0.0 * lean[..., None]
        bent[..., 1] = bent[..., 1] * (1.0 + self.size * lean * (1.0 + self.bend * lean))
        return bent


def tilt_lift(rng: np.random.Generator) -> Hidden:
    """Lift that depends on the lean, slightly non-linear."""
    bend = rng.uniform(-0.5, 0.5)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        return model.with_board(coefficient_modifier=Leaning(size, bend))

    return Hidden('tilt_lift', '1/rad', 0.4, (2.0, 2.0), gear=gear)


def gear_weight(rng: np.random.Generator) -> Hidden:
    """Boards or clumps of another weight."""
    boards = bool(rng.integers(2))

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        more = size / model.water.gravity
        if boards:
            return model.with_board(mass=model.board.mass + more)
        mass = model.lump_mass.copy()
        mass[[model.layout.footrope[0], model.layout.footrope[-1]]] += more
        return replace(model, lump_mass=mass)

    return Hidden('gear_weight', 'N', 1000.0, (5000.0, 5000.0), gear=gear)


def depth_sensor(rng: np.random.Generator) -> Hidden:
    """Depth sensors with an error: at the doors, at the net, or growing at all of them."""
    kind = ('doors', 'net', 'drift')[int(rng.integers(3))]
    bend = rng.uniform(0.8, 1.2)

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        names = {'doors': DOORS, 'net': ('net_depth',), 'drift': DEPTHS}[kind]
        error = 0.5 * size * at.hours**bend if kind == 'drift' else size
        return readings | {name: readings[name] + error for name in names}

    most = 20.0 if kind == 'drift' else 30.0
    return Hidden('depth_sensor', 'm', 3.0, (most, most), shown=shown)


def tension_cell(rng: np.random.Generator) -> Hidden:
    """Load cells with another slope and a slight non-linearity."""
    bend = rng.uniform(-0.1, 0.1)

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        return readings | {
            name: readings[name] * (1.0 + size * (1.0 + bend * (readings[name] / 80e3 - 1.0)))
            for name in CABLES
        }

    return Hidden('tension_cell', '', 0.1, (0.2, 0.2), shown=shown)


def spread_sensor(rng: np.random.Generator) -> Hidden:
    """Speed of sound that differs from the one the spread sensor assumes."""
    bend = rng.uniform(-0.1, 0.1)

    def shown(size: float, readings: Readings, at: Situation) -> Readings:
        spread = readings['door_spread']
        return readings | {'door_spread': spread * (1.0 + size * (1.0 + bend * (spread / 60 - 1)))}

    return Hidden('spread_sensor', '', 0.05, (0.15, 0.15), shown=shown)


def heave(rng: np.random.Generator) -> Hidden:
    """Sea state that falls or rises during the tows."""
    change = rng.uniform(-0.1, 0.1)

    def towed(size: float, inputs: FloatArray, at: Situation) -> FloatArray:
        variance = size * (1.0 + change * at.hours)
        return np.array([*inputs[:2], np.sqrt(inputs[2] ** 2 + variance)])

    return Hidden('heave', 'm²/s²', 0.2, (0.0, 1.5), towed=towed)


@dataclass(frozen=True)
class Drag:
    """Node force: mud or sand that holds everything below a depth."""

    nodes: IntArray
    depth: float
    hold: float
    carry: float
    ahead: FloatArray

    def __call__(self, positions: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return friction, and the vertical reaction of part of it."""
        under = 0.5 * (1.0 + np.tanh((-positions[..., 2] - self.depth) / 6.0))
        way = np.array([*-self.ahead, self.carry])
        forces: FloatArray = self.hold * under[..., None] * way + 0.0 * velocities
        return forces


def bottom_contact(rng: np.random.Generator) -> Hidden:
    """Softer bottom, which carries less than it holds."""
    carry, depth = rng.uniform(0.7, 1.1), rng.uniform(150.0, 200.0)

    def gear(size: float, model: GearModel, at: Situation) -> GearModel:
        ends = np.array([model.layout.footrope[0], model.layout.footrope[-1]])
        ground = Drag(ends, depth, size, carry, ahead(at))
        return replace(model, node_forces=(*model.node_forces, ground))

    return Hidden('bottom_contact', 'N', 1000.0, (0.0, 10e3), gear=gear)


INSIDE: Mapping[str, Draw] = {
    draw.__name__: draw
    for draw in (
        board_stall, bottom_contact, catch_build_up, counter_offset, counter_scale, cross_current,
        current_shear, depth_sensor, gear_weight, heave, net_drag, speed_log, spread_sensor,
        tension_cell, tilt_lift, warp_asymmetry, warp_strumming,
    )
}  # fmt: skip
"""Effects of the catalogue that are visible in steady tows."""
