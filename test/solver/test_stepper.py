"""Motion in time: stays where nothing pushes, converges, and settles where it should."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np

from trawl_ros.lab.validation.closed_forms.free_rotation import momentum_and_energy, spinning
from trawl_ros.model.assembly import forces, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.state import Tow
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.stepper import Motion, Stepper, StepperOptions, at_rest

Boundary = Callable[[float], Tow]


def towed_on(tow: Tow, t: float) -> Tow:
    return replace(tow, blocks=tow.blocks + t * tow.block_velocities)


TO_ROUNDING = StepperOptions(tolerance=1e-8)
"""Leaves of a step's error only what the method itself makes."""


def run(model: GearModel, start: Motion, boundary: Boundary, h: float, end: float) -> Motion:
    stepper, motion = Stepper(model, TO_ROUNDING), start
    for k in range(round(end / h)):
        motion = stepper.step(motion, boundary((k + 1) * h), h)
    return motion


def test_an_equilibrium_stays_what_it_is(model: GearModel, steady: SteadyState) -> None:
    found = steady.equilibrium
    stepper, motion = Stepper(model), at_rest(found.state)
    for k in range(100):
        motion = stepper.step(motion, towed_on(found.tow, 0.1 * (k + 1)), 0.1)
    moved = found.tow.block_velocities[0] * 10.0
    assert np.abs(motion.state.nodes - found.state.nodes - moved).max() < 1e-4
    seen = observe(model, motion.state, towed_on(found.tow, 10.0)).array()
    np.testing.assert_allclose(seen, found.observables.array(), rtol=1e-5, atol=1e-7)
    # Nothing changes, so one factorisation serves all steps.
    assert stepper.factorisations == 1


def manoeuvre(tow: Tow, t: float) -> Tow:
    """Pays out smoothly from 0 to 0.6 m/s and back within 4 s, more to port."""
    share, width = np.array([1.0, 0.6]), 4.0
    phase = 2 * np.pi * min(t, width) / width
    rate = 0.3 * (1 - np.cos(phase))
    out = 0.3 * (min(t, width) - width / (2 * np.pi) * np.sin(phase))
    return replace(towed_on(tow, t), lengths=tow.lengths + share * out, length_rates=share * rate)


def test_it_converges_with_the_square_of_the_step(model: GearModel, steady: SteadyState) -> None:
    found = steady.equilibrium
    ends = [
        run(model, at_rest(found.state), lambda t: manoeuvre(found.tow, t), h, 4.0).state
        for h in (0.1, 0.05, 0.025)
    ]
    where = [
        np.concatenate(
            [end.nodes.ravel(), end.board_positions.ravel(), end.board_rotations.ravel()]
        )
        for end in ends
    ]
    first, second = (np.abs(a - b).max() for a, b in pairwise(where))
    assert np.log2(first / second) >= 1.8
    assert first < 0.01


def test_a_free_board_keeps_its_energy_and_angular_momentum() -> None:
    model, state, tow = spinning()
    inertia = model.pattern.matrix(mass(model, state, tow)).toarray()
    first = np.linalg.solve(inertia, forces(model, state, tow))
    before, energy = momentum_and_energy(model, state)
    errors = []
    for h in (0.2, 0.1):
        end = run(model, Motion(state, first, first), lambda t: tow, h, 50.0).state
        after, left = momentum_and_energy(model, end)
        errors.append(
            (np.abs(after - before).max() / np.abs(before).max(), abs(left / energy - 1.0))
        )
        # It did turn, and turned over: the body's axes are far from where they were.
        assert np.einsum('ij,ij->', end.board_rotations[0], state.board_rotations[0]) < 2.0
    momentum, energies = np.array(errors).T
    assert momentum[1] < 1e-3
    assert momentum[1] < momentum[0] / 3.0
    assert energies.max() < 1e-4


def test_without_the_gyroscopic_moment_it_would_not() -> None:
    model, state, tow = spinning()
    generalised = forces(model, state, tow)[3 * model.nodes :].reshape(2, 6)
    spin, _ = momentum_and_energy(model, state)
    np.testing.assert_allclose(
        generalised[:, 3:], -np.cross(state.board_rates, spin), rtol=1e-9, atol=1e-9
    )
    assert np.abs(generalised[:, 3:]).max() > 50.0
    np.testing.assert_allclose(generalised[:, :3], 0.0, atol=1e-9)
