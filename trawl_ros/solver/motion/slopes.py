# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Derivatives of a motion by parameters, from one time step to the next.

A step solves F(q, v, u, p) = M(q*, u, p) a for the new acceleration a, with q = w + c_q a and
v = s + c_v a. Here w and s follow from the motion before the step, q* is the predicted position, u
the towing boundary and p a parameter. The derivative of the root by p solves the same equation,
linearised, with K = -∂F/∂q and C = -∂F/∂v:

(K T c_q + C c_v + M) ∂a
    = ∂F/∂p + ∂F/∂u ∂u - K ∂w - C ∂s - ∂(M a)/∂p - ∂(M a)/∂(q*, u) (∂q*, ∂u)

One factorisation serves, with one right-hand side for each parameter. A board's rotation is exp(w)
times the one before, so its rows of ∂w are J ∂w + exp(w) ∂θ. T is the left Jacobian of SO(3),
J = I + (1 - cos |w|) / |w|² S + (|w| - sin |w|) / |w|³ S² with S b = w × b, in the columns of
rotations, and the identity elsewhere.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray, Slice
from trawl_ros.model.assembly import LinearisedForces, linearised
from trawl_ros.model.compiled import njit_fastmath
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.numerics import skew
from trawl_ros.model.rotations import rotation
from trawl_ros.model.slopes.along import (
    RiggingDirections,
    net_inertia_slopes,
    subtract_rigging_inertia,
)
from trawl_ros.model.state import State, Tow, TowSlopes
from trawl_ros.solver.linear.factor import Factor, factorised
from trawl_ros.solver.stepper import Scheme, SolvedStep

BOARD_ROWS = 12
"""Degrees of freedom of both boards, the last rows of every array (dof, ...)."""


@dataclass(frozen=True)
class MotionSlopes:
    """Derivatives of a motion by m parameters.

    ``places`` (dof, m) are metres and, of the boards, rotation vectors in fixed axes;
    ``velocities``, ``accelerations`` and ``averaged`` accelerations (dof, m) as in `Motion`.
    """

    places: FloatArray
    velocities: FloatArray
    accelerations: FloatArray
    averaged: FloatArray

    @property
    def arrays(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Derivatives in this order."""
        return self.places, self.velocities, self.accelerations, self.averaged

    def weighted(self, weights: FloatArray, rows: Slice | IntArray) -> FloatArray:
        """Return rows of a weighted sum of all derivatives but the places, by weights (3,)."""
        parts = self.velocities[rows], self.accelerations[rows], self.averaged[rows]
        found: FloatArray = weights[0] * parts[0] + weights[1] * parts[1] + weights[2] * parts[2]
        return found


def unmoved(dof: int, number: int) -> MotionSlopes:
    """Return zero derivatives by a number of parameters."""
    return MotionSlopes(*np.zeros((4, dof, number)))


def left_jacobian(vectors: FloatArray) -> FloatArray:
    """Return the left Jacobian (..., 3, 3) of SO(3) at rotation vectors (..., 3).

    To first order, exp(w + δ) = exp(J δ) exp(w).
    """
    # J = I + (1 - cos θ)/θ² [w]× + (θ - sin θ)/θ³ [w]×²; series for small θ avoid cancellation.
    square = np.sum(vectors**2, axis=-1)[..., None, None]
    size = np.sqrt(np.maximum(square, 1e-12))
    quick = square < 1e-6
    first = np.where(quick, 0.5 - square / 24, (1 - np.cos(size)) / size**2)
    second = np.where(quick, 1 / 6 - square / 120, (size - np.sin(size)) / size**3)
    turn = skew(vectors)
    tangent: FloatArray = np.eye(3) + first * turn + second * (turn @ turn)
    return tangent


def _turned_on(before: FloatArray, change: FloatArray, shift: FloatArray) -> FloatArray:
    """Return the changes of the boards' places (12, m) after a displacement.

    Parameters
    ----------
    before
        Changes (12, m) at its start.
    change
        Changes of the displacement (12, m): metres, and rotation vectors.
    shift
        The displacement itself (dof,).
    """
    vectors = shift[-BOARD_ROWS:].reshape(2, 6)[:, 3:]
    found: FloatArray = before + change
    old, added = (part.reshape(2, 6, -1)[:, 3:] for part in (before, change))
    found.reshape(2, 6, -1)[:, 3:] = left_jacobian(vectors) @ added + rotation(vectors) @ old
    return found


@dataclass(frozen=True)
class LinearisedStep:
    """Linearisation of a solved step, with the factors of its matrix.

    ``predicted`` is the state at which the step takes the gear's mass, and ``inertia_slopes`` are
    the derivatives of this mass times the acceleration.
    """

    solved: SolvedStep
    predicted: State
    here: LinearisedForces
    inertia_slopes: FloatArray
    factor: Factor

    def at(self, solved: SolvedStep) -> 'LinearisedStep':
        """Return the same linearisation for a root nearby."""
        return replace(self, solved=solved)


def linearise_step(model: GearModel, solved: SolvedStep, tow: Tow) -> LinearisedStep:
    """Linearise a step at its root.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    step, new, scheme = solved.step, solved.acceleration, solved.step.scheme
    by_velocity, by_position = scheme.by_velocity(step.h), scheme.by_position(step.h)
    here = linearised(model, step.state(new), tow)
    stiffness = _by_vectors(model, here.stiffness, step.displacement(new))
    data = stiffness + (by_velocity / by_position) * here.damping + solved.inertia / by_position
    predicted = step.state(step.start.averaged)
    slopes = net_inertia_slopes(model, predicted, tow, new)
    return LinearisedStep(solved, predicted, here, slopes, factorised(model.pattern, data))


def _by_vectors(model: GearModel, data: FloatArray, shift: FloatArray) -> FloatArray:
    """Change a matrix from derivatives by rotations to those by rotation vectors ``shift``."""
    found, indptr = data.copy(), model.pattern.indptr
    tangents = left_jacobian(shift[-12:].reshape(2, 6)[:, 3:])
    for side, tangent in enumerate(tangents):
        # These three columns share their rows: those of the board and of the ropes rigged to it.
        first = model.dof - 12 + 6 * side + 3
        columns = found[indptr[first] : indptr[first + 3]].reshape(3, -1)
        columns[:] = tangent.T @ columns
    matrix: FloatArray = found
    return matrix


def advance_slopes(
    model: GearModel,
    at: LinearisedStep,
    before: MotionSlopes,
    tow: Tow,
    boundary: TowSlopes,
    push: FloatArray,
) -> MotionSlopes:
    """Return the derivatives after a step.

    Parameters
    ----------
    model, tow
        Gear, and the boundary at the step's end.
    at
        The step, linearised at its root.
    before
        Derivatives at its start.
    boundary
        Derivatives of the boundary at its end.
    push
        Derivatives (dof, m) of F - M a at its end by the parameters, all motion held; overwritten
        by the right-hand sides.
    """
    step, new = at.solved.step, at.solved.acceleration
    h, scheme, averaged = step.h, step.scheme, step.start.averaged
    weights = _Weights.of(scheme, h)
    boards = slice(model.dof - BOARD_ROWS, None)
    old, way = before.places[boards], before.weighted(weights.way, boards)
    predicted_way = before.weighted(weights.predicted_way, boards)
    turned = _turned_on(old, predicted_way, step.displacement(averaged))
    rows = model.rigging.rows(model.nodes)
    predicted = before.places[rows] + before.weighted(weights.predicted_way, rows)
    moved = RiggingDirections(predicted, turned, boundary)
    subtract_rigging_inertia(model, at.predicted, tow, new, moved, push)
    pattern, here = model.pattern, at.here
    _subtract_history(
        pattern.indices.view(np.uint32),
        pattern.indptr,
        here.stiffness,
        here.damping,
        at.inertia_slopes,
        weights.way,
        weights.predicted_way,
        weights.pace,
        before.arrays,
        _turned_on(old, way, step.displacement(new)),
        turned,
        push,
    )
    shift = at.factor.solve(push)
    after = MotionSlopes(*np.empty((4, *shift.shape)))
    share = np.array([1.0, scheme.by_velocity(h), 1.0, scheme.share])
    share[1:] /= scheme.by_position(h)
    _carry_on(weights.way, weights.pace, weights.known, share, before.arrays, shift, after.arrays)
    after.places[boards] = _turned_on(old, way + shift[boards], step.displacement(new))
    return after


@dataclass(frozen=True)
class _Weights:
    """Weights (3,) of velocities, accelerations and averaged accelerations before a step.

    They give the known parts of its averaged acceleration, its displacement, the displacement to
    the predicted place, and its velocity.
    """

    known: FloatArray
    way: FloatArray
    predicted_way: FloatArray
    pace: FloatArray

    @classmethod
    def of(cls, scheme: Scheme, h: float) -> '_Weights':
        """Return the weights of a step of ``h`` seconds, by the linear scheme on unit vectors."""
        velocities, accelerations, averaged = np.eye(3)
        known = scheme.known_acceleration(accelerations, averaged)
        way = scheme.predicted_displacement(velocities, averaged, known, h)
        pace = scheme.predicted_velocity(velocities, averaged, known, h)
        return cls(known, way, way + scheme.by_position(h) * averaged, pace)


@njit_fastmath
def _subtract_history(
    indices: IntArray,
    indptr: IntArray,
    stiffness: FloatArray,
    damping: FloatArray,
    slopes: FloatArray,
    way: FloatArray,
    predicted_way: FloatArray,
    pace: FloatArray,
    before: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    reached_boards: FloatArray,
    predicted_boards: FloatArray,
    right: FloatArray,
) -> None:
    """Subtract stiffness · reached + damping · pace + slopes · predicted from ``right`` (dof, m).

    The matrices are data on one pattern, whose columns come in threes of equal rows. ``way``,
    ``predicted_way`` and ``pace`` are weights (3,) of the velocities, accelerations and averaged
    accelerations among the derivatives ``before`` the step, whose places come first.
    """
    # All parameters at once: derivatives (dof, m) exceed the cache, so each is read once a step.
    number = right.shape[1]
    x, v, p = np.empty((3, number)), np.empty((3, number)), np.empty((3, number))
    tail = len(right) - BOARD_ROWS
    for column in range(0, len(right), 3):
        for i in range(3):
            place, speed = before[0][column + i], before[1][column + i]
            old, mean = before[2][column + i], before[3][column + i]
            for m in range(number):
                x[i, m] = place[m] + way[0] * speed[m] + way[1] * old[m] + way[2] * mean[m]
                p[i, m] = x[i, m] + (predicted_way[2] - way[2]) * mean[m]
                v[i, m] = pace[0] * speed[m] + pace[1] * old[m] + pace[2] * mean[m]
            # Boards rotate, so the caller has worked out the changes of their places.
            if column >= tail:
                x[i], p[i] = (
                    reached_boards[column - tail + i],
                    predicted_boards[column - tail + i],
                )
        first, second, third = indptr[column], indptr[column + 1], indptr[column + 2]
        for entry in range(second - first):
            i, j, k = first + entry, second + entry, third + entry
            row = right[indices[i]]
            a0, a1, a2 = stiffness[i], stiffness[j], stiffness[k]
            b0, b1, b2 = damping[i], damping[j], damping[k]
            c0, c1, c2 = slopes[i], slopes[j], slopes[k]
            for m in range(number):
                row[m] -= (
                    (a0 * x[0, m] + a1 * x[1, m] + a2 * x[2, m])
                    + (b0 * v[0, m] + b1 * v[1, m] + b2 * v[2, m])
                    + (c0 * p[0, m] + c1 * p[1, m] + c2 * p[2, m])
                )


@njit_fastmath
def _carry_on(
    way: FloatArray,
    pace: FloatArray,
    known: FloatArray,
    by_shift: FloatArray,
    before: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    shift: FloatArray,
    after: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Fill in the derivatives after a step from those before it and from the solution ``shift``.

    ``by_shift`` (4,) is its share in places, velocities, accelerations and averaged accelerations.
    ``known`` are weights (3,), as those of `_subtract_history`.
    """
    for row in range(len(shift)):
        place, speed, old, mean = before[0][row], before[1][row], before[2][row], before[3][row]
        new = shift[row]
        for m in range(len(new)):
            s, a, b = speed[m], old[m], mean[m]
            after[0][row, m] = (
                place[m] + way[0] * s + way[1] * a + way[2] * b + by_shift[0] * new[m]
            )
            after[1][row, m] = pace[0] * s + pace[1] * a + pace[2] * b + by_shift[1] * new[m]
            after[2][row, m] = by_shift[2] * new[m]
            after[3][row, m] = known[1] * a + known[2] * b + by_shift[3] * new[m]
