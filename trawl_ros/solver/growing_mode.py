"""Growing mode of an unstable steady state: the part that moves, and its motion."""

import numpy as np

from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.modes import linearised_motion

BESIDE = 0.01
"""Distance (1/s) from a known eigenvalue at which its mode is sought."""

TOLERANCE = 1e-4

MOTIONS = 'surge', 'sway', 'heave', 'roll', 'pitch', 'yaw'

METRES_PER_RADIAN = 10.0
"""Move of a board or node that counts as much as a turn of a board by one radian."""

TOGETHER = 0.3
"""Share of its largest motion from which half of the net's nodes move as one."""

MIRROR = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
"""Signs of a board's move and turn in its mirror image."""


def growing_mode(model: GearModel, state: State, tow: Tow, eigenvalue: complex) -> str:
    """Name the mode of an eigenvalue (1/s), such as 'heave of one board against the other'."""
    motion = linearised_motion(model, state, tow)
    values, shapes = motion.nearest(eigenvalue + BESIDE, 2, tolerance=TOLERANCE)
    if not len(values):
        return 'a motion'
    shape = shapes[:, np.argmin(np.abs(values - eigenvalue))]
    # Axes along the course, so that a board's surge is the gear's.
    ahead = tow.block_velocities.mean(0)
    angle = np.arctan2(ahead[1], ahead[0])
    turn = np.array(
        [[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]]
    )
    count = model.nodes
    nodes = np.abs(shape[: 3 * count].reshape(count, 3)).max(axis=1)
    boards = shape[3 * count :].reshape(2, 2, 3) @ turn.T
    boards = (boards * [[1.0], [METRES_PER_RADIAN]]).reshape(2, 6)
    net = nodes[model.layout.net]
    if np.abs(boards).max() < net.max():
        together = np.median(net) > TOGETHER * net.max()
        name = 'a motion of the whole net' if together else 'a flutter of netting'
    else:
        kind = int(np.argmax(np.abs(boards).max(axis=0)))
        even = np.abs(boards[0] + MIRROR * boards[1]).max()
        odd = np.abs(boards[0] - MIRROR * boards[1]).max()
        name = f'{MOTIONS[kind]} of ' + (
            'both boards' if even > odd else 'one board against the other'
        )
    swing = abs(eigenvalue.imag)
    return f'{name}, swinging in {2 * np.pi / swing:.1f} s,' if swing > BESIDE else name
