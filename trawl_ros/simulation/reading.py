"""Ground truth of a state: the seam between the model and everything that observes it."""

import numpy as np
from scipy.spatial.transform import Rotation

from trawl_ros.core.arrays import FloatArray, IntArray
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
)
from trawl_ros.simulation.section import section_of, sonar_axes
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
    quaternions = Rotation.from_matrix(turn).as_quat(canonical=True)

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


def read_truth(
    model: GearModel, stamp: int, ship: Ship, winches: tuple[Winch, Winch], state: State, tow: Tow
) -> Truth:
    """Read the truth of a state for the instruments."""
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
            sonar_orientation=Rotation.from_matrix(sonar).as_quat(canonical=True),
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


def _resampled(points: FloatArray, number: int) -> FloatArray:
    """As many points along a rope, its ends and middle among them; a planned net's footrope may
    have other nodes than its headrope.
    """
    if len(points) == number:
        return points
    along = np.linspace(0.0, len(points) - 1, number)
    steps = np.arange(len(points))
    return np.stack([np.interp(along, steps, axis) for axis in points.T], axis=1)


def _means(values: FloatArray, groups: list[IntArray]) -> list[float]:
    """Means of ``values`` over index groups, vectorised as there are a thousand of them."""
    sizes = np.array([len(group) for group in groups])
    starts = np.concatenate([[0], np.cumsum(sizes)[:-1]])
    sums = np.add.reduceat(values[np.concatenate(groups)], starts)
    return list((sums / sizes).tolist())


def read_picture(model: GearModel, stamp: int, state: State, tow: Tow) -> GearPicture:
    """Picture of the gear for drawing: every rope and bar with its tension."""
    points = points_of(model, state, tow).positions
    tensions = _means(bar_tensions(model, state, tow), [bars for *_, bars in model.layout.lines])
    return GearPicture(
        stamp=stamp,
        lines=tuple(
            Polyline(name, points[numbers], tension)
            for (name, numbers, _), tension in zip(model.layout.lines, tensions, strict=True)
        ),
        doors=_doors(model, state),
        door_size=(model.board.chord, model.board.span),
    )
