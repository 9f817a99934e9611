"""Derivatives of a motion by parameters, and of one time step: the discrete map, differentiated.

A step solves F(q, v) = M a for the new acceleration, with q and v linear in it. The derivative of
its root by any parameter solves the same equation, linearised there: one factorisation, one
right-hand side for each parameter. Rotations advance by exponentials, whose tangent (the left
Jacobian of SO(3)) enters the matrix and the history alike.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray, Slice
from trawl_ros.model.assembly import LinearisedForces, linearised
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
from trawl_ros.solver.motion.products import BOARDS, carry_on, subtract_history
from trawl_ros.solver.stepper import Scheme, SolvedStep


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
        """All of them in this order."""
        return self.places, self.velocities, self.accelerations, self.averaged

    def weighted(self, weights: FloatArray, rows: Slice | IntArray) -> FloatArray:
        """Some rows of a sum of all but the places, by weights (3,)."""
        parts = self.velocities[rows], self.accelerations[rows], self.averaged[rows]
        found: FloatArray = weights[0] * parts[0] + weights[1] * parts[1] + weights[2] * parts[2]
        return found


def unmoved(dof: int, number: int) -> MotionSlopes:
    """Derivatives of a motion that does not depend on so many parameters."""
    return MotionSlopes(*np.zeros((4, dof, number)))


def left_jacobian(vectors: FloatArray) -> FloatArray:
    """Tangent (..., 3, 3) of the exponential of rotation vectors (..., 3): exp(w + δ) =
    exp(J δ) exp(w) to first order.
    """
    square = np.sum(vectors**2, axis=-1)[..., None, None]
    size = np.sqrt(np.maximum(square, 1e-12))
    small = square < 1e-6
    first = np.where(small, 0.5 - square / 24, (1 - np.cos(size)) / size**2)
    second = np.where(small, 1 / 6 - square / 120, (size - np.sin(size)) / size**3)
    turn = skew(vectors)
    tangent: FloatArray = np.eye(3) + first * turn + second * (turn @ turn)
    return tangent


def _turned_on(before: FloatArray, change: FloatArray, shift: FloatArray) -> FloatArray:
    """Changes of the boards' places (12, m) at the end of a way.

    Parameters
    ----------
    before
        Changes (12, m) at its start.
    change
        Of the way (12, m): metres, and rotation vectors.
    shift
        The way itself (dof,).
    """
    vectors = shift[-BOARDS:].reshape(2, 6)[:, 3:]
    found: FloatArray = before + change
    old, added = (part.reshape(2, 6, -1)[:, 3:] for part in (before, change))
    found.reshape(2, 6, -1)[:, 3:] = left_jacobian(vectors) @ added + rotation(vectors) @ old
    return found


@dataclass(frozen=True)
class LinearisedStep:
    """Linearisation of a solved step, with the factors of its matrix; ``predicted`` is the state at
    which it takes the gear's mass, whose derivatives times acceleration are ``inertia_slopes``.
    """

    solved: SolvedStep
    predicted: State
    here: LinearisedForces
    inertia_slopes: FloatArray
    factor: Factor

    def at(self, solved: SolvedStep) -> 'LinearisedStep':
        """The same linearisation for a root nearby."""
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
    stiffness = _by_vectors(model, here.stiffness, step.shift(new))
    data = stiffness + (by_velocity / by_position) * here.damping + solved.inertia / by_position
    predicted = step.state(step.start.averaged)
    slopes = net_inertia_slopes(model, predicted, tow, new)
    return LinearisedStep(solved, predicted, here, slopes, factorised(model.pattern, data))


def _by_vectors(model: GearModel, data: FloatArray, shift: FloatArray) -> FloatArray:
    """Data of a matrix by the boards' rotation vectors ``shift`` instead of by rotations."""
    found, indptr = data.copy(), model.pattern.indptr
    tangents = left_jacobian(shift[-12:].reshape(2, 6)[:, 3:])
    for side, tangent in enumerate(tangents):
        # The three columns have the same rows: their board's and those of the ropes rigged to it.
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
    """Derivatives after a step.

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
        Derivatives (dof, m) of F - M a at its end by the parameters, all motion held; it serves as
        space for the right-hand sides.
    """
    step, new = at.solved.step, at.solved.acceleration
    h, scheme, averaged = step.h, step.scheme, step.start.averaged
    weights = _Weights.of(scheme, h)
    boards = slice(model.dof - BOARDS, None)
    old, way = before.places[boards], before.weighted(weights.way, boards)
    predicted_way = before.weighted(weights.predicted_way, boards)
    turned = _turned_on(old, predicted_way, step.shift(averaged))
    rows = model.rigging.rows(model.nodes)
    predicted = before.places[rows] + before.weighted(weights.predicted_way, rows)
    moved = RiggingDirections(predicted, turned, boundary)
    subtract_rigging_inertia(model, at.predicted, tow, new, moved, push)
    pattern, here = model.pattern, at.here
    subtract_history(
        pattern.indices.view(np.uint32),
        pattern.indptr,
        here.stiffness,
        here.damping,
        at.inertia_slopes,
        weights.way,
        weights.predicted_way,
        weights.pace,
        before.arrays,
        _turned_on(old, way, step.shift(new)),
        turned,
        push,
    )
    shift = at.factor.solve(push)
    after = MotionSlopes(*np.empty((4, *shift.shape)))
    share = np.array([1.0, scheme.by_velocity(h), 1.0, scheme.share])
    share[1:] /= scheme.by_position(h)
    carry_on(weights.way, weights.pace, weights.carried, share, before.arrays, shift, after.arrays)
    after.places[boards] = _turned_on(old, way + shift[boards], step.shift(new))
    return after


@dataclass(frozen=True)
class _Weights:
    """Weights (3,) of velocities, accelerations and averaged ones before a step in what is known
    of it: averaged acceleration, way, way to the predicted place, and velocity.
    """

    carried: FloatArray
    way: FloatArray
    predicted_way: FloatArray
    pace: FloatArray

    @classmethod
    def of(cls, scheme: Scheme, h: float) -> '_Weights':
        """Weights of a step of ``h`` seconds: all of it is linear, so unit vectors tell them."""
        velocities, accelerations, averaged = np.eye(3)
        carried = scheme.carried(accelerations, averaged)
        way = scheme.way(velocities, averaged, carried, h)
        pace = scheme.pace(velocities, averaged, carried, h)
        return cls(carried, way, way + scheme.by_position(h) * averaged, pace)
