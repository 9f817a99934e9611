"""The otter board as a rigid body with six degrees of freedom (eq. 1-19).

All of the physics is written once, in the *outward* frame: x forward, y away from the net's
middle, z up. For the port board that is its right-handed body frame (x forward, y port,
z up); the starboard board is its mirror image, reached by the sign ``outward`` alone.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trawl_ros.model.hooks import CoefficientModifier
from trawl_ros.model.numerics import about_axis, angle, cross, dot, length, transpose
from trawl_ros.model.water import Water

COEFFICIENTS = ('a1', 'c1', 'a2', 'c2', 'b3', 'c3', 'a4', 'c4', 'b5', 'c5', 'a6', 'c6')
"""Names of the twelve coefficients in the order of eq. 36."""

LAW_RANGE = (0.0, np.radians(40.0))
"""Attack angles (rad) for which eq. 14 holds as it stands."""

LAW_END = (np.radians(-40.0), np.radians(90.0))
"""Attack angles (rad) at which, outside that range, lift and moments have faded to nothing."""

SLIP_LIMIT = np.radians(40.0)
"""Slip angle (rad) beyond which its part of eq. 14 stays constant."""

LEAST_ACROSS = np.cos(SLIP_LIMIT) ** 2
"""Part of the squared flow that lies in the board's x-y plane below which, the flow then running
along the span, the law's forces and moments fade with that part."""

ROUNDING = np.radians(4.0)
"""Width (rad) over which an angle comes to rest outside its range."""


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
    moment_signs : tuple of float
        Signs with which the printed moment coefficients act in the outward frame.
    slip_sign : float
        Sign with which β of eq. 2 enters eq. 14.
    flow_axes : bool
        True: C_x along the flow in the board's x-y plane and C_y across it; False: along
        the board's own axes.
    rotary_slope : float
        Slope of lift per radian with which strips of a turning board resist its turning; zero
        as in the paper, or by the gear file.
    added_mass : (3,) array
        Added mass along the board's axes, kg; zero as in eq. 15, or by the gear file.
    bend : Bend or None
        Modifier of the coefficients of eq. 14; None leaves them as they are.
    """

    mass: float
    volume: float
    inertia: np.ndarray
    area: float
    span: float
    chord: float
    points: np.ndarray
    installation: tuple[float, float, float]
    moment_signs: tuple[float, float, float]
    slip_sign: float
    flow_axes: bool
    rotary_slope: float
    added_mass: np.ndarray
    bend: CoefficientModifier | None = None

    @cached_property
    def fastening_points(self) -> np.ndarray:
        """Fastening points (3, 3) in the outward board frame, installation angles applied."""
        yaw, pitch, roll = self.installation
        turn = about_axis(2, yaw) @ about_axis(1, pitch) @ about_axis(0, roll)
        return self.points @ turn

    @property
    def rotary_areas(self) -> np.ndarray:
        """Second moments of the board's area about its x and z axes, m⁴, none about y."""
        b, chord = self.span, self.chord
        return np.array([chord * b**3 / 12, 0.0, b * chord**3 / 12])

    @property
    def levers(self) -> np.ndarray:
        """Lever lengths d_x, d_y, d_z of eq. 13, m."""
        return np.array([self.span, np.hypot(self.span, self.chord), self.chord])


def _settled(value: np.ndarray, low: float, high: float) -> np.ndarray:
    """Saturate the angle smoothly: unchanged inside [low, high], constant well outside."""
    over = np.real(value) - high
    under = low - np.real(value)
    if (over <= 0).all() and (under <= 0).all():
        return value
    above = np.where(
        over < ROUNDING, value - (value - high) ** 2 / (2 * ROUNDING), high + ROUNDING / 2
    )
    below = np.where(
        under < ROUNDING, value + (value - low) ** 2 / (2 * ROUNDING), low - ROUNDING / 2
    )
    return np.where(over > 0, above, np.where(under > 0, below, value))


def _fading(attack: np.ndarray) -> np.ndarray:
    """Fade factor of the law: 1 inside its range, falling smoothly to 0 at `LAW_END`."""
    if ((np.real(attack) >= LAW_RANGE[0]) & (np.real(attack) <= LAW_RANGE[1])).all():
        return np.ones_like(attack)
    up = (attack - LAW_RANGE[1]) / (LAW_END[1] - LAW_RANGE[1])
    down = (attack - LAW_RANGE[0]) / (LAW_END[0] - LAW_RANGE[0])
    share = np.where(np.real(up) > 0, up, np.where(np.real(down) > 0, down, 0.0))
    share = np.where(np.real(share) > 1, 1.0, share)
    return 1.0 - share**2 * (3.0 - 2.0 * share)


def _folded(attack: np.ndarray) -> np.ndarray:
    """The attack angle for drag: flow on the inner face meets as much board as on the outer."""
    if (np.real(attack) >= 0).all():
        return attack
    dip = attack * (1.0 + attack / ROUNDING)
    inner = np.where(np.real(attack) > -ROUNDING, dip, -attack - ROUNDING)
    return np.where(np.real(attack) < 0, inner, attack)


def _across(flow: np.ndarray) -> np.ndarray:
    """Fade factor of α: 1, but smoothly 0 where the flow runs along the span and α is undefined."""
    part = dot(flow[..., :2], flow[..., :2]) / (dot(flow, flow) + 1e-18) / LEAST_ACROSS
    return np.where(np.real(part) < 1.0, part * (2.0 - part), 1.0)


def coefficients_at(values: np.ndarray, attack: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """The six force and moment coefficients at given angles (eq. 14).

    Parameters
    ----------
    values : (12,) array
        In the order of `COEFFICIENTS`, per radian and dimensionless.
    attack, slip : (...) arrays
        α and β, rad.

    Returns
    -------
    (..., 6) array
        C_x^F, C_y^F, C_z^F, C_x^M, C_y^M, C_z^M. Outside 0-40° of attack lift, moments and
        the slip's part fade, drag stays and never becomes thrust; outside ±40° of slip its
        part stays.
    """
    a1, c1, a2, c2, b3, c3, a4, c4, b5, c5, a6, c6 = values
    fade = _fading(attack)
    alpha = _settled(attack, *LAW_RANGE)
    beta = _settled(slip, -SLIP_LIMIT, SLIP_LIMIT)
    resistance = a1 * _settled(_folded(attack), *LAW_RANGE) + c1
    resistance = np.where(np.real(resistance) > 0, resistance, 0.0)
    parts = [
        resistance,
        (a2 * alpha + c2) * fade,
        b3 * beta * fade + c3,
        (a4 * alpha + c4) * fade,
        b5 * beta * fade + c5,
        (a6 * alpha + c6) * fade,
    ]
    return np.stack(parts, -1)


def mirrored_axes(outward: np.ndarray) -> np.ndarray:
    """Signs (..., 3) that turn the outward frame's axes into the door frame's."""
    signs = np.ones((*outward.shape, 3))
    signs[..., 1] = outward
    return signs


@dataclass(frozen=True)
class BoardFlow:
    """Relative flow at boards: angles α, β (rad), flow in the outward frame (..., 3) m/s,
    density (kg/m³), and the vertical part ``lean`` of the outward normal.
    """

    attack: np.ndarray
    slip: np.ndarray
    flow: np.ndarray
    density: np.ndarray
    lean: np.ndarray


def flow_at(
    board: Board,
    outward: np.ndarray,
    position: np.ndarray,
    rotation: np.ndarray,
    velocity: np.ndarray,
    rate: np.ndarray,
    water: Water,
) -> BoardFlow:
    """Relative water velocity and orientation angles (eq. 1-4).

    The board's velocity is the mean of its three fastening points' (eq. 4). Angles come from
    ``arctan2``, which equals eq. 1 and 2 within ±90° and does not fold beyond.
    """
    mirror = mirrored_axes(outward)
    middle = mirror * board.fastening_points.mean(0)
    arm = np.einsum('...ij,...j->...i', rotation, middle)
    water_velocity = water.current(position[..., 2])
    relative = water_velocity - velocity - cross(rate, arm)
    flow = mirror * np.einsum('...ji,...j->...i', rotation, relative)
    ahead = -flow[..., 0]
    return BoardFlow(
        attack=angle(flow[..., 1], ahead),
        slip=angle(flow[..., 2], ahead),
        flow=flow,
        density=water.density_at(position[..., 2]),
        lean=outward * rotation[..., 2, 1],
    )


def hydrodynamics(board: Board, values: np.ndarray, flow: BoardFlow) -> tuple:
    """Force (..., 3) N and moment (..., 3) N m in the outward frame (eq. 12-14)."""
    coefficients = coefficients_at(values, flow.attack, board.slip_sign * flow.slip)
    if board.bend is not None:
        coefficients = board.bend(coefficients, flow.attack, flow.slip, flow.lean)
    coefficients = coefficients * _across(flow.flow)[..., None]
    pressure = 0.5 * flow.density * board.area * dot(flow.flow, flow.flow)
    if board.flow_axes:
        plane = length(flow.flow[..., :2], 1e-9)
        along = flow.flow[..., 0] / plane, flow.flow[..., 1] / plane
        cx, cy = coefficients[..., 0], coefficients[..., 1]
        ahead, across = cx * along[0] + cy * along[1], cx * along[1] - cy * along[0]
        force = np.stack([ahead, across, coefficients[..., 2]], -1)
    else:
        force = coefficients[..., :3]
    moment = coefficients[..., 3:] * board.levers * np.asarray(board.moment_signs)
    return pressure[..., None] * force, pressure[..., None] * moment


def world_inertia(board: Board, outward: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Inertia about the centre of gravity in fixed axes, (..., 3, 3) kg m²."""
    mirror = mirrored_axes(outward)
    body = mirror[..., :, None] * board.inertia * mirror[..., None, :]
    return rotation @ body @ transpose(rotation)


def own_load(
    board: Board,
    values: np.ndarray,
    outward: np.ndarray,
    position: np.ndarray,
    rotation: np.ndarray,
    velocity: np.ndarray,
    rate: np.ndarray,
    water: Water,
) -> np.ndarray:
    """Force and moment (..., 6) in fixed axes that do not come from ropes.

    Hydrodynamics (eq. 12-14), weight and buoyancy (eq. 19) and the gyroscopic moment
    -ω × Iω, which eq. 15 drops and which a spinning board needs to keep its angular momentum.
    """
    mirror = mirrored_axes(outward)
    flow = flow_at(board, outward, position, rotation, velocity, rate, water)
    force, moment = hydrodynamics(board, values, flow)
    force = np.einsum('...ij,...j->...i', rotation, mirror * force)
    # A moment is an axial vector: its mirror image carries the reflection's determinant too.
    moment = np.einsum('...ij,...j->...i', rotation, outward[..., None] * mirror * moment)
    # Each strip of a turning board meets the flow at an attack angle of its own: ω r / u.
    turning = np.einsum('...ji,...j->...i', rotation, rate)
    resistance = 0.5 * flow.density * length(flow.flow, 1e-9) * board.rotary_slope
    slowing = -resistance[..., None] * board.rotary_areas * turning
    moment = moment + np.einsum('...ij,...j->...i', rotation, slowing)
    heavy = (board.mass - flow.density * board.volume) * water.gravity
    force = force - heavy[..., None] * np.array([0.0, 0.0, 1.0])
    spin = np.einsum('...ij,...j->...i', world_inertia(board, outward, rotation), rate)
    return np.concatenate([force, moment - cross(rate, spin)], -1)


def inclination(rotation: np.ndarray) -> np.ndarray:
    """Inclination δ (rad, unsigned) of the board's z axis against the vertical (eq. 38)."""
    upright = rotation[..., 2, 2]
    flat = np.sqrt(rotation[..., 0, 2] ** 2 + rotation[..., 1, 2] ** 2)
    return angle(flat, upright)


def pitch_and_roll(rotation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pitch (nose down positive) and roll (top to starboard positive), rad, as
    R = Rz(yaw) Ry(pitch) Rx(roll) in the right-handed door frame.
    """
    nose = -rotation[..., 2, 0]
    level = np.sqrt(rotation[..., 0, 0] ** 2 + rotation[..., 1, 0] ** 2)
    return angle(nose, level), angle(rotation[..., 2, 1], rotation[..., 2, 2])
