# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""The otter board as a rigid body with six degrees of freedom (eq. 1-19).

The physics is written once, in the *outward* frame: x forward, y away from the net's middle, z up.
For the port board this is its right-handed body frame (x forward, y port, z up). The starboard
board is the mirror image; the sign ``outward`` is the only difference.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.bar_pass import water_of
from trawl_ros.model.board_law import fill_flow, fill_loads, fill_own_loads, fill_total
from trawl_ros.model.board_laws import EQ14, BoardLaw, real_like
from trawl_ros.model.compiled import as_kind
from trawl_ros.model.hooks import CoefficientModifier
from trawl_ros.model.numerics import STEP, transpose
from trawl_ros.model.rotations import about_axis
from trawl_ros.model.water import Water

Angles = tuple[float, float, float]
"""Installation angles ε, ζ, η, rad."""

AS_INSTALLED: Angles = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Board:
    """Properties of an otter board.

    Parameters
    ----------
    mass, volume : float
        kg and m³.
    inertia : (3, 3) array
        About the centre of gravity in the outward frame, kg m² (eq. 16).
    area, span, chord : float
        S_o (m²), b and l (m) of eq. 12, 13.
    points : (3, 3) array
        Fastening points of warp, upper and lower bridle in the outward frame, m, before the
        installation angles.
    installation : tuple of float
        ε, ζ, η (rad): turns of the board about its z, y and x axes against its rigging.
    rotary_slope : float
        Slope of lift per radian with which strips of a turning board resist the rotation; zero
        in the paper, otherwise from the gear file.
    added_mass : (3,) array
        Added mass along the board's axes, kg; zero in eq. 15, otherwise from the gear file.
    coefficient_modifier : CoefficientModifier or None
        Modifier of the coefficients of the law; None for none.
    rerigged : tuple of tuples of float
        Deviation (rad) of the installation angles of the port and of the starboard board from
        ``installation``.
    law : BoardLaw
        Law whose parameters are the board's coefficients.
    """

    mass: float
    volume: float
    inertia: FloatArray
    area: float
    span: float
    chord: float
    points: FloatArray
    installation: Angles
    rotary_slope: float
    added_mass: FloatArray
    coefficient_modifier: CoefficientModifier | None = None
    law: BoardLaw = EQ14
    rerigged: tuple[Angles, Angles] = (AS_INSTALLED, AS_INSTALLED)

    @property
    def is_plain(self) -> bool:
        """True for unmodified eq. 14, whose loads are compiled as a whole."""
        return self.coefficient_modifier is None and self.law == EQ14

    @cached_property
    def installed(self) -> FloatArray:
        """Rotation (3, 3) of the installation angles; row vectors times it are the board's."""
        return _turn(self.installation)

    @cached_property
    def fastening_points(self) -> FloatArray:
        """Fastening points (3, 3) in the outward board frame, installation angles applied."""
        return self.points @ self.installed

    @cached_property
    def fastening_by_side(self) -> FloatArray:
        """Fastening points (2, 3, 3) of both boards, each in its outward frame."""
        turns = [np.add(self.installation, own) for own in self.rerigged]
        points: FloatArray = np.stack([self.points @ _turn(turn) for turn in turns])
        return points

    @cached_property
    def rotary_resistance(self) -> FloatArray:
        """Rotary slope times second moments of area about the x and z axes, m⁴; zero about y."""
        b, chord = self.span, self.chord
        areas: FloatArray = np.array([chord * b**3 / 12, 0.0, b * chord**3 / 12])
        return self.rotary_slope * areas

    @cached_property
    def levers(self) -> FloatArray:
        """Lever lengths d_x, d_y, d_z of eq. 13, m."""
        return np.array([self.span, np.hypot(self.span, self.chord), self.chord])

    @cached_property
    def middles(self) -> FloatArray:
        """Means (2, 3) of the boards' fastening points in their outward frames, m (eq. 4)."""
        means: FloatArray = self.fastening_by_side.sum(1) / 3
        return means

    def middle(self, outward: FloatArray) -> FloatArray:
        """Return the mean (..., 3) of the fastening points of the board on this side (...,)."""
        port, starboard = self.middles
        middle: FloatArray = np.where(np.real(outward)[..., None] > 0.0, port, starboard)
        return middle


def _turn(angles: Angles | FloatArray) -> FloatArray:
    yaw, pitch, roll = angles
    return about_axis(2, yaw) @ about_axis(1, pitch) @ about_axis(0, roll)


def mirrored_axes(outward: FloatArray) -> FloatArray:
    """Return the signs (..., 3) between the axes of the outward frame and of the door frame."""
    signs = np.ones((*outward.shape, 3))
    signs[..., 1] = outward
    return signs


@dataclass(frozen=True)
class BoardFlow:
    """Relative flow at boards.

    Attributes
    ----------
    attack, slip : (...) arrays
        Angles α and β, rad.
    flow : (..., 3) array
        Velocity of the water relative to the board in the outward frame, m/s.
    density : (...) array
        Density of the water, kg/m³.
    lean, rise : (...) arrays
        Vertical parts of the outward normal and of the forward axis.
    """

    attack: FloatArray
    slip: FloatArray
    flow: FloatArray
    density: FloatArray
    lean: FloatArray
    rise: FloatArray


def flow_at(
    board: Board,
    outward: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    water: Water,
) -> BoardFlow:
    """Return the relative water velocity and the orientation angles (eq. 1-4).

    The board's velocity is the mean velocity of its three fastening points (eq. 4). Angles come
    from ``arctan2``, which equals eq. 1 and 2 within ±90° and is unique beyond.
    """
    shape = np.broadcast_shapes(
        np.shape(outward), position.shape[:-1], rotation.shape[:-2], velocity.shape[:-1]
    )
    outward = np.broadcast_to(outward, shape)
    relative = np.broadcast_to(water.current(position[..., 2]) - velocity, (*shape, 3))
    given = (
        board.middle(outward.ravel()),
        outward.ravel(),
        np.broadcast_to(rotation, (*shape, 3, 3)).reshape(-1, 3, 3),
        relative.reshape(-1, 3),
        np.broadcast_to(rate, (*shape, 3)).reshape(-1, 3),
    )
    flow = np.empty(given[3].shape, complex)
    attack, slip = np.empty((2, len(flow)), complex)
    fill_flow(*as_kind(complex, *given), flow, attack, slip)
    return BoardFlow(
        attack=real_like(given, attack).reshape(shape),
        slip=real_like(given, slip).reshape(shape),
        flow=real_like(given, flow).reshape(*shape, 3),
        density=np.broadcast_to(water.density_at(position[..., 2]), shape),
        lean=outward * rotation[..., 2, 1],
        rise=np.broadcast_to(rotation[..., 2, 0], shape),
    )


def hydrodynamics(
    board: Board, values: FloatArray, flow: BoardFlow
) -> tuple[FloatArray, FloatArray]:
    """Return force (..., 3) N and moment (..., 3) N m in the outward frame (eq. 12-14)."""
    coefficients = board.law(values, flow.attack, flow.slip, flow.lean, flow.rise)
    if board.coefficient_modifier is not None:
        coefficients = board.coefficient_modifier(coefficients, flow.attack, flow.slip, flow.lean)
    given = flow.density.ravel(), flow.flow.reshape(-1, 3), coefficients.reshape(-1, 6)
    loads = np.empty((2, *given[1].shape), complex)
    fill_loads(
        float(board.area),
        board.levers,
        *as_kind(complex, *given),
        loads[0],
        loads[1],
    )
    force, moment = real_like(given, loads)
    return force.reshape(flow.flow.shape), moment.reshape(flow.flow.shape)


def world_inertia(board: Board, outward: FloatArray, rotation: FloatArray) -> FloatArray:
    """Return the inertia about the centre of gravity in fixed axes, (..., 3, 3) kg m²."""
    mirror = mirrored_axes(outward)
    body = mirror[..., :, None] * board.inertia * mirror[..., None, :]
    return rotation @ body @ transpose(rotation)


def own_load(
    board: Board,
    values: FloatArray,
    outward: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    water: Water,
) -> FloatArray:
    """Return the force and moment (..., 6) in fixed axes that do not come from ropes.

    They are hydrodynamics (eq. 12-14), weight and buoyancy (eq. 19) and the gyroscopic moment
    -ω × Iω. Eq. 15 omits the latter; without it a spinning board would not conserve its angular
    momentum.
    """
    shape = np.broadcast_shapes(
        np.shape(outward), position.shape[:-1], rotation.shape[:-2], velocity.shape[:-1]
    )
    side = _flat(outward, shape)
    given = (
        values,
        board.middle(side),
        side,
        _flat(position, shape, 3),
        _flat(rotation, shape, 3, 3),
        _flat(velocity, shape, 3),
        _flat(rate, shape, 3),
    )
    turning = board.inertia, board.rotary_resistance
    if board.is_plain:
        total = _by_formula(board, as_kind(complex, *given), water)
        return real_like(given, total).reshape(*shape, 6)
    total = np.empty((len(given[2]), 6), complex)
    flow = flow_at(board, outward, position, rotation, velocity, rate, water)
    force, moment = (_flat(part, shape, 3) for part in hydrodynamics(board, values, flow))
    heavy = (board.mass - flow.density * board.volume) * water.gravity
    rest = (
        _flat(heavy, shape),
        given[2],
        given[4],
        given[6],
        _flat(flow.density, shape),
        _flat(flow.flow, shape, 3),
        force,
        moment,
    )
    fill_total(*turning, *as_kind(complex, *rest), total)
    return real_like(rest, total).reshape(*shape, 6)


def _by_formula(board: Board, given: list[FloatArray], water: Water) -> FloatArray:
    """Return loads (n, 6) by eq. 14 from coefficients, middle and motion as in `own_load`."""
    total = np.empty((len(given[2]), 6), complex)
    fill_own_loads(
        float(board.mass),
        float(board.volume),
        float(board.area),
        board.levers,
        board.inertia,
        board.rotary_resistance,
        *given,
        water_of(water),
        total,
    )
    return total


def own_load_slopes(
    board: Board,
    values: FloatArray,
    outward: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    velocity: FloatArray,
    rate: FloatArray,
    water: Water,
) -> FloatArray:
    """Return the derivatives (n, 6, q) of `own_load` of ``n`` boards by the coefficients."""
    moving = position, rotation, velocity, rate
    steps = values + 1j * STEP * np.eye(len(values))
    if board.is_plain:
        _, *rest = as_kind(complex, values, board.middle(outward), outward, *moving)
        loads = [_by_formula(board, [step, *rest], water) for step in steps]
    else:
        loads = [own_load(board, step, outward, *moving, water) for step in steps]
    return np.stack(loads, axis=-1).imag / STEP


def _flat(array: FloatArray, shape: tuple[int, ...], *tail: int) -> FloatArray:
    """Return the array with one row per board."""
    whole = (*shape, *tail)
    if np.shape(array) != whole:
        array = np.broadcast_to(array, whole)
    return array.reshape(-1, *tail)
