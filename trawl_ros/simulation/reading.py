# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Ground truth of a state: the interface between the model and everything that observes it."""

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.model.assembly import bar_tensions, points_of
from trawl_ros.model.board import flow_at, hydrodynamics, mirrored_axes
from trawl_ros.model.gear_model import OUTWARD, GearModel
from trawl_ros.model.numerics import transpose
from trawl_ros.model.observables import observe
from trawl_ros.model.state import State, Tow
from trawl_ros.records.truth import (
    DoorTruth,
    GearPicture,
    NetTruth,
    Polyline,
    Truth,
    VesselTruth,
    WinchTruth,
    single,
)
from trawl_ros.simulation.ship import Ship, Winch


def _doors(model: GearModel, state: State) -> tuple[DoorTruth, DoorTruth]:
    flow = flow_at(
        model.board,
        OUTWARD,
        state.board_positions,
        state.board_rotations,
        state.board_velocities,
        state.board_rates,
        model.water,
    )
    force, moment = hydrodynamics(model.board, model.coefficients, flow)
    mirror = mirrored_axes(OUTWARD)
    turn = state.board_rotations
    back = transpose(turn)
    lean = np.arccos(np.clip(turn[:, 2, 2], -1.0, 1.0))
    quaternions = [quaternion_of(one) for one in turn]

    def door(k: int) -> DoorTruth:
        return DoorTruth(
            position=state.board_positions[k],
            orientation=quaternions[k],
            velocity=back[k] @ state.board_velocities[k],
            angular_velocity=back[k] @ state.board_rates[k],
            attack=float(flow.attack[k]),
            slip=float(flow.slip[k]),
            inclination=float(lean[k]),
            force=mirror[k] * force[k],
            moment=OUTWARD[k] * mirror[k] * moment[k],
        )

    return door(0), door(1)


def quaternion_of(rotation: FloatArray) -> FloatArray:
    """Return the quaternion (x, y, z, w) of a rotation matrix (3, 3), with w ≥ 0.

    The largest component comes first (Shepperd 1978). SciPy checks the matrix, at ten times the
    cost.
    """
    m = rotation.tolist()
    trace = m[0][0] + m[1][1] + m[2][2]
    i = max(range(3), key=lambda k: m[k][k])
    j, k = (i + 1) % 3, (i + 2) % 3
    if trace > m[i][i]:
        found = np.array([m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1], 1.0 + trace])
    else:
        found = np.empty(4)
        found[i] = 1.0 - trace + 2.0 * m[i][i]
        found[j], found[k] = m[j][i] + m[i][j], m[k][i] + m[i][k]
        found[3] = m[k][j] - m[j][k]
    quaternion: FloatArray = found / np.copysign(np.linalg.norm(found), found[3])
    return quaternion


def read_truth(
    model: GearModel, stamp: int, ship: Ship, winches: tuple[Winch, Winch], state: State, tow: Tow
) -> Truth:
    """Return the truth of a state for the instruments."""
    observables = observe(model, state, tow)
    head, foot = model.layout.headrope, model.layout.footrope
    sonar = sonar_axes(model, state)
    return Truth(
        stamp=stamp,
        doors=_doors(model, state),
        winches=(
            WinchTruth(winches[0].length, winches[0].speed, float(observables.port_tension)),
            WinchTruth(winches[1].length, winches[1].speed, float(observables.starboard_tension)),
        ),
        net=NetTruth(
            mouth=np.concatenate(
                [state.nodes[head], _resampled(state.nodes[foot[::-1]], len(head))]
            ),
            horizontal_opening=float(observables.horizontal_opening),
            vertical_opening=float(observables.vertical_opening),
            headrope_depth=float(observables.net_depth),
            sonar_position=state.nodes[head[len(head) // 2]],
            sonar_orientation=quaternion_of(sonar),
            section=section_of(model, state, sonar),
        ),
        vessel=VesselTruth(
            position=ship.position,
            heading=ship.heading,
            yaw_rate=ship.yaw_rate,
            velocity_ground=ship.velocity + model.water.surface_current,
            velocity_water=np.array([ship.speed, 0.0, ship.heave_rate]),
        ),
        observables=observables,
    )


def sonar_axes(model: GearModel, state: State) -> FloatArray:
    """Return the axes of frame ``sonar`` as columns (3, 3).

    Axis z is forward along the mouth's normal, x down in the mouth, y to port.
    """
    layout = model.layout
    head, foot = layout.headrope, layout.footrope
    port = state.nodes[head[0]] - state.nodes[head[-1]]
    down = state.nodes[foot[len(foot) // 2]] - state.nodes[head[len(head) // 2]]
    down = down - (down @ port) / (port @ port) * port
    x, y = down / np.linalg.norm(down), port / np.linalg.norm(port)
    return np.column_stack([x, y, np.cross(x, y)])


def section_of(model: GearModel, state: State, axes: FloatArray) -> FloatArray:
    """Return the intersections of ropes and twine with the plane z = 0 of frame ``sonar``.

    A numerical bar that stands for several real ones has one intersection with the diameter of one
    real bar. The node that carries the sonar is left out.

    Parameters
    ----------
    model, state
        Gear and its state.
    axes
        Axes from `sonar_axes`.

    Returns
    -------
    array
        Section of `NetTruth`, shape (k, 3).
    """
    head, foot = model.layout.headrope, model.layout.footrope
    sonar, middle = head[len(head) // 2], foot[len(foot) // 2]
    positions = (state.nodes - state.nodes[sonar]) @ axes
    # Both lie in the plane by definition; rounding must not decide which bars cross there.
    positions[[sonar, middle], 2] = 0.0
    # Bars at boards and blocks are far ahead of the mouth; their point numbers exceed the nodes.
    inner = np.flatnonzero((model.ends < model.nodes).all(axis=1) & (model.bars.normal_area > 0))
    start, end = model.ends[inner].T
    behind = positions[:, 2] < 0.0
    through = (behind[start] != behind[end]) & (start != sonar) & (end != sonar)
    bars, a, b = inner[through], positions[start[through]], positions[end[through]]
    share = a[:, 2] / (a[:, 2] - b[:, 2])
    places = (a + share[:, None] * (b - a))[:, :2]
    # n bars of diameter d have the volume n π d² / 4 and the area n d per metre.
    diameters = 4 / np.pi * model.bars.volume[bars] / model.bars.normal_area[bars]
    # The footrope touches the plane with its middle, but may not pass through it.
    lowest = [*positions[middle, :2], model.gear.footrope.diameter_m]
    return single(np.vstack([np.column_stack([places, diameters]), lowest]))


def _resampled(points: FloatArray, number: int) -> FloatArray:
    """Return ``number`` points along a rope, with its ends and middle.

    The footrope of a planned net may have another number of nodes than its headrope.
    """
    if len(points) == number:
        return points
    along = np.linspace(0.0, len(points) - 1, number)
    steps = np.arange(len(points))
    return np.stack([np.interp(along, steps, axis) for axis in points.T], axis=1)


def read_picture(model: GearModel, stamp: int, state: State, tow: Tow) -> GearPicture:
    """Return a picture of the gear for drawing: every rope and bar with its tension."""
    drawn = model.layout.drawn
    places = points_of(model, state, tow).positions[drawn.points]
    tensions = np.add.reduceat(bar_tensions(model, state, tow)[drawn.bars], drawn.first_bars)
    means = (tensions / np.diff(drawn.first_bars, append=len(drawn.bars))).tolist()
    return GearPicture(
        stamp=stamp,
        lines=tuple(
            Polyline(name, places[begin:end], tension)
            for name, begin, end, tension in zip(
                drawn.names, drawn.first_points, [*drawn.first_points[1:], None], means
            )
        ),
        doors=_doors(model, state),
        door_size=(model.board.chord, model.board.span),
    )
