"""Patches of an implicit step: in balance by the forces of the whole gear, and on the way only."""

import numpy as np
import pytest

from trawl_ros.lab.benchmark.haul import haul_of
from trawl_ros.model.assembly import forces, linearised, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver import patches, stepper
from trawl_ros.solver.equilibrium import SteadyState
from trawl_ros.solver.linear.fronts import dense_solution
from trawl_ros.solver.patches import NO_PATCH, ImplicitStep, PatchOptions, balanced, grown_patch
from trawl_ros.solver.stepper import SCHEME, Step, StepperOptions, at_rest

H = 0.2
ENOUGH = 1e-9
OF_SMALL_GEARS = PatchOptions(min_gear_nodes=0, max_fraction=1.0)


@pytest.fixture
def step(model: GearModel, steady: SteadyState) -> ImplicitStep:
    found = steady.equilibrium
    inertia = mass(model, found.state, found.tow)
    return ImplicitStep(inertia, SCHEME.by_position(H), SCHEME.by_velocity(H), ENOUGH)


@pytest.fixture
def patch(model: GearModel) -> np.ndarray:
    """Nodes of the netting, and those next to a board and to a towing block."""
    rigged, hung = model.ends[model.pattern.rigged[0], 1], model.ends[model.pattern.hung[0], 1]
    return np.unique([*model.layout.net[20:26], rigged, hung])


def test_a_patch_has_forces_and_matrix_of_the_whole_gear(
    model: GearModel, steady: SteadyState, step: ImplicitStep, patch: np.ndarray
) -> None:
    found = steady.equilibrium
    a = np.random.default_rng(1).normal(size=model.dof)
    nodes = patches._PatchForces.of(model, found.state, found.tow, step, patch)
    left, matrix = nodes.linearised(a[: 3 * model.nodes].reshape(-1, 3)[patch])
    rows = (3 * patch[:, None] + np.arange(3)).ravel()
    there = linearised(model, found.state, found.tow)
    data = there.stiffness + (step.by_velocity / step.by_position) * there.damping
    whole = model.pattern.matrix(data + step.inertia / step.by_position)
    expected = whole[rows][:, rows].toarray()
    np.testing.assert_allclose(matrix, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    force = (there.force - model.pattern.times(step.inertia, a))[rows]
    np.testing.assert_allclose(left.ravel(), force, rtol=1e-9, atol=1e-9 * np.abs(force).max())


def test_a_balanced_patch_has_no_force_left_and_moves_nothing_else(
    model: GearModel, steady: SteadyState, step: ImplicitStep, patch: np.ndarray
) -> None:
    found = steady.equilibrium
    steps = Step(at_rest(found.state), H)
    flung = np.zeros(model.dof)
    nodes = flung[: 3 * model.nodes].reshape(-1, 3)
    nodes[patch] = np.random.default_rng(2).normal(size=(len(patch), 3))
    new = balanced(model, steps.state(flung), found.tow, step, flung, patch)
    left = forces(model, steps.state(new), found.tow) - model.pattern.times(step.inertia, new)
    own = np.zeros(model.dof, bool)
    own[: 3 * model.nodes].reshape(-1, 3)[patch] = True
    assert np.abs(left[own]).max() < 1e-3
    assert np.abs(left[~own]).max() > 1.0
    assert np.array_equal(new[~own], flung[~own])
    assert not np.array_equal(new[own], flung[own])


def test_a_patch_without_balance_stays_as_it_was(
    model: GearModel, steady: SteadyState, step: ImplicitStep, patch: np.ndarray
) -> None:
    found, flung = steady.equilibrium, np.ones(model.dof)
    state = Step(at_rest(found.state), H).state(flung)
    once = PatchOptions(iterations=1)
    assert balanced(model, state, found.tow, step, flung, patch, once) is flung


def test_a_patch_grows_by_nodes_of_large_corrections(model: GearModel) -> None:
    correction = np.zeros(model.dof)
    kite = model.layout.kite.nodes
    correction[3 * np.array([7, 9, kite[0]])] = 1.0
    correction[3 * 8] = 0.001
    assert len(grown_patch(model, NO_PATCH, correction, ENOUGH)) == 0
    given = correction, ENOUGH, OF_SMALL_GEARS
    assert grown_patch(model, NO_PATCH, *given).tolist() == [7, 9]
    assert grown_patch(model, np.array([8]), *given).tolist() == [7, 8, 9]
    everywhere = np.ones(model.dof)
    assert len(grown_patch(model, np.array([8]), everywhere, ENOUGH, OF_SMALL_GEARS)) == 0


def test_a_tow_with_patches_is_that_without(
    model: GearModel, steady: SteadyState, monkeypatch
) -> None:
    haul = haul_of(model, 40.0, steady.equilibrium)
    without = haul.run(H)
    calls = []
    monkeypatch.setattr(
        stepper, 'balanced', lambda *given: calls.append(len(given[-2])) or balanced(*given)
    )
    with_patches = haul.run(H, options=StepperOptions(patches=OF_SMALL_GEARS))
    assert calls
    ranges = np.ptp(without.seen, axis=0)
    assert (np.abs(with_patches.seen - without.seen).max(axis=0) / ranges).max() < 1e-4
    assert with_patches.factorisations < without.factorisations


def test_a_dense_system_is_solved() -> None:
    rng = np.random.default_rng(3)
    matrix, right = rng.normal(size=(30, 30)), rng.normal(size=30)
    np.testing.assert_allclose(
        dense_solution(matrix, right), np.linalg.solve(matrix, right), rtol=1e-9
    )
    assert dense_solution(np.zeros((3, 3)), np.ones(3)) is None
