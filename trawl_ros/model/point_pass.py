# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""One pass over the points of a gear: their motion, and loads and masses of nodes and boards.

Points are numbered as in `trawl_ros.model.gear_model`: nodes, three fastening points of either
board, two blocks.
"""

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.model.compiled import compiled


@compiled
def fill_points(
    fastening: FloatArray,
    outward: FloatArray,
    nodes: FloatArray,
    node_velocities: FloatArray,
    boards: FloatArray,
    board_velocities: FloatArray,
    rotations: FloatArray,
    rates: FloatArray,
    blocks: FloatArray,
    block_velocities: FloatArray,
    x: FloatArray,
    v: FloatArray,
    arms: FloatArray,
) -> None:
    """Fill in positions and velocities (p, 3) of all points, and arms (2, 3, 3) of boards.

    Arms lead from the boards' centres of gravity to their fastening points, in fixed axes; the
    points ``fastening`` (2, 3, 3) are given in the outward frame.
    """
    count = len(nodes)
    for n in range(count):
        for i in range(3):
            x[n, i], v[n, i] = nodes[n, i], node_velocities[n, i]
    for side in range(2):
        turn, spin = rotations[side], rates[side]
        for point in range(3):
            arm, row = arms[side, point], count + 3 * side + point
            fixed = fastening[side, point]
            aside = fixed[1] * outward[side]
            for i in range(3):
                arm[i] = turn[i, 0] * fixed[0] + turn[i, 1] * aside
                arm[i] += turn[i, 2] * fixed[2]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                x[row, i] = boards[side, i] + arm[i]
                v[row, i] = board_velocities[side, i] + (spin[j] * arm[k] - spin[k] * arm[j])
        for i in range(3):
            x[count + 6 + side, i] = blocks[side, i]
            v[count + 6 + side, i] = block_velocities[side, i]


@compiled
def gather_loads(
    points: FloatArray,
    arms: FloatArray,
    boards: FloatArray,
    kite: FloatArray,
    shares: FloatArray,
    carriers: IntArray,
    force: FloatArray,
) -> None:
    """Fill in the generalised forces (dof,) from the loads of points, boards and kite.

    Loads are (p, 3), (2, 6) and (3,); ``carriers`` are the nodes that share the load of the kite. A
    board has the pull of the ropes at its fastening points and their moment Σ arm × rope.
    """
    count = len(points) - 8
    for n in range(count):
        for i in range(3):
            force[3 * n + i] = points[n, i]
    for carrier in range(len(carriers)):
        for i in range(3):
            force[3 * carriers[carrier] + i] += shares[carrier] * kite[i]
    for side in range(2):
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            pull, moment = 0 * kite[0], 0 * kite[0]
            for point in range(3):
                arm, rope = arms[side, point], points[count + 3 * side + point]
                pull += rope[i]
                moment += arm[j] * rope[k] - arm[k] * rope[j]
            force[3 * count + 6 * side + i] = boards[side, i] + pull
            force[3 * count + 6 * side + 3 + i] = boards[side, 3 + i] + moment


@compiled
def fill_masses(
    own: FloatArray,
    added: FloatArray,
    density: FloatArray,
    kite: FloatArray,
    lumps: FloatArray,
    canvas: FloatArray,
) -> None:
    """Fill in the masses of nodes (n, 3, 3) and of the kite's carrying nodes (9, 9).

    ``own`` masses are in kg, ``added`` ones in kg per kg/m³ of water.
    """
    lumps[:], canvas[:] = 0.0, 0.0
    for n in range(len(lumps)):
        for i in range(3):
            lumps[n, i, i] = own[n] + density[n] * added[n]
    for carrier in range(len(kite)):
        for i in range(3):
            canvas[3 * carrier + i, 3 * carrier + i] = kite[carrier]


@compiled
def fill_board_masses(
    mass: float,
    inertia: FloatArray,
    added: FloatArray,
    outward: FloatArray,
    rotations: FloatArray,
    arms: FloatArray,
    half: FloatArray,
    rig_board: IntArray,
    rig_point: IntArray,
    rigged: FloatArray,
    bodies: FloatArray,
) -> None:
    """Fill in the masses of boards (2, 6, 6) and of the bars rigged to them (r, 9, 9).

    Boards have their mass and inertia in fixed axes. ``half`` (r, 3, 3) is half of the mass of the
    bars; it acts on the board and on the node at the bar's other end.
    """
    rigged[:], bodies[:] = 0.0, 0.0
    for bar in range(len(half)):
        arm, own, out = arms[rig_board[bar], rig_point[bar]], half[bar], rigged[bar]
        for i in range(3):
            for j in range(3):
                # The point moves by δX + δθ × a.
                j1, j2 = (j + 1) % 3, (j + 2) % 3
                out[i, j] = out[6 + i, 6 + j] = own[i, j]
                out[i, 3 + j] = own[i, j2] * arm[j1] - own[i, j1] * arm[j2]
                out[3 + j, i] = own[j2, i] * arm[j1] - own[j1, i] * arm[j2]
        for i in range(3):
            i1, i2 = (i + 1) % 3, (i + 2) % 3
            for j in range(3):
                out[3 + i, 3 + j] = arm[i1] * out[i2, 3 + j] - arm[i2] * out[i1, 3 + j]
    for side in range(2):
        turn, body = rotations[side], bodies[side]
        for i in range(3):
            body[i, i] = mass
            for j in range(3):
                for k in range(3):
                    body[i, j] += turn[i, k] * added[k] * turn[j, k]
                    for m in range(3):
                        # In the door frame the products of inertia with y change sign.
                        sign = outward[side] if (k == 1) != (m == 1) else 1.0
                        body[3 + i, 3 + j] += turn[i, k] * sign * inertia[k, m] * turn[j, m]
