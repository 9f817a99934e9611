# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Stability of a steady state by the eigenvalues of its linearised motion, and its growing mode."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.modes import LinearisedMotion, linearised_motion

SWINGING = (0.3 + 1.0j, 1.0 + 3.0j, 0.7 + 7.5j, 0.7 + 11.0j, 0.5 + 15.0j)
"""Shifts (1/s) near oscillations of boards on their ropes, and of netting."""

SHIFT_OFFSET = 0.01
"""Distance (1/s) of a shift from a known eigenvalue, to find its mode."""

MODE_TOLERANCE = 1e-4
"""Relative error of the eigenvalue of that mode."""

BOARD_MOTIONS = 'surge', 'sway', 'heave', 'roll', 'pitch', 'yaw'

METRES_PER_RADIAN = 10.0
"""Displacement of a board or node that counts as much as a rotation of a board by one radian."""

COHERENT_FRACTION = 0.3
"""The whole net moves if the median of its nodes moves by this fraction of the largest motion."""

MIRROR_SIGNS = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
"""Signs of a board's displacement and rotation in its mirror image."""


@dataclass(frozen=True)
class StabilityOptions:
    """Options of the search for the least stable motions.

    Attributes
    ----------
    drift_shift, drifts
        Shift (1/s) near slow drifts of the whole gear, and number of them.
    fall_shift
        Shift (1/s) near the fall of a board, which takes about a second.
    min_fall_growth
        Growth (1/s) of a fall; slower ones are found among the drifts.
    swing_shifts
        Shifts (1/s) near oscillations.
    tolerance, swing_tolerance
        Error of a converged eigenvalue, relative to its distance from the shift.
    min_swing_frequency
        Frequency (rad/s) below which a motion is a drift, which is found more precisely as such.
    max_candidate_error
        Error up to which an eigenvalue is a candidate for faster growth, so that it is followed
        until it converges. Eigenvalues of decaying motions fill a disk in 1 / (λ - s). Those of
        growing motions lie outside, where Arnoldi's method converges first.
    min_vectors
        Vectors after which a growing motion has appeared among the candidates.
    """

    drift_shift: float = 0.02
    drifts: int = 6
    fall_shift: float = 0.5
    min_fall_growth: float = 0.03
    swing_shifts: tuple[complex, ...] = SWINGING
    tolerance: float = 1e-5
    swing_tolerance: float = 1e-3
    min_swing_frequency: float = 0.05
    max_candidate_error: float = 0.2
    min_vectors: int = 16


@dataclass(frozen=True)
class Stability:
    """The eigenvalues (1/s) nearest to instability; ``growth`` is the largest real part."""

    eigenvalues: FloatArray

    @property
    def growth(self) -> float:
        """Rate of growth (1/s) of the least stable motion; negative if all decay."""
        return float(self.eigenvalues.real.max())

    @property
    def stable(self) -> bool:
        """True if every motion found decays."""
        return self.growth < 0.0

    @property
    def settling_time(self) -> float:
        """Time (s) in which the slowest motion decays to 1/e."""
        return -1.0 / self.growth if self.stable else float('inf')


def stability(
    model: GearModel, state: State, tow: Tow, options: StabilityOptions = StabilityOptions()
) -> Stability:
    """Find the eigenvalues of M ẍ + C ẋ + K x = 0 near the imaginary axis.

    These are the slow drifts, and of the other motions those that may be less stable.
    """
    motion = linearised_motion(model, state, tow)
    drifting, _ = motion.nearest(options.drift_shift, options.drifts, tolerance=options.tolerance)
    found = [drifting]
    growth = float(drifting.real.max(initial=-np.inf))
    for shift in (options.fall_shift, *options.swing_shifts):
        values = _growing(motion, shift, growth, options)
        growth = float(values.real.max(initial=growth))
        found.append(values)
    return Stability(np.concatenate(found))


def _growing(
    motion: LinearisedMotion, shift: complex, growth: float, options: StabilityOptions
) -> FloatArray:
    """Find falls or oscillations around a shift; all that grow faster than known are among them."""
    falling = shift == options.fall_shift
    tolerance = options.tolerance if falling else options.swing_tolerance

    def counts(values: FloatArray) -> BoolArray:
        swinging: BoolArray = np.abs(values.imag) > options.min_swing_frequency
        return values.real > options.min_fall_growth if falling else swinging

    def enough(values: FloatArray, errors: FloatArray) -> bool:
        candidates = (values.real > growth) & (errors < options.max_candidate_error)
        open_errors = errors[counts(values) & candidates]
        return len(values) >= options.min_vectors and bool(np.all(open_errors <= tolerance))

    around = motion.around(shift, enough)
    found = around.values[around.residuals <= tolerance]
    return found[counts(found)]


def growing_mode(model: GearModel, state: State, tow: Tow, eigenvalue: complex) -> str:
    """Name the mode of an eigenvalue (1/s), such as 'heave of one board against the other'."""
    motion = linearised_motion(model, state, tow)
    # The shift is near the eigenvalue and not on it, where the matrix would be singular.
    values, shapes = motion.nearest(eigenvalue + SHIFT_OFFSET, 2, tolerance=MODE_TOLERANCE)
    if not len(values):
        return 'a motion'
    shape = shapes[:, np.argmin(np.abs(values - eigenvalue))]
    # Rotate to axes along the course, so that the surge of a board is along the course.
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
        together = np.median(net) > COHERENT_FRACTION * net.max()
        name = 'a motion of the whole net' if together else 'a flutter of netting'
    else:
        kind = int(np.argmax(np.abs(boards).max(axis=0)))
        even = np.abs(boards[0] + MIRROR_SIGNS * boards[1]).max()
        odd = np.abs(boards[0] - MIRROR_SIGNS * boards[1]).max()
        name = f'{BOARD_MOTIONS[kind]} of ' + (
            'both boards' if even > odd else 'one board against the other'
        )
    swing = abs(eigenvalue.imag)
    return f'{name}, swinging in {2 * np.pi / swing:.1f} s,' if swing > SHIFT_OFFSET else name
