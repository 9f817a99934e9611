"""One code path for both sides: a mirrored case gives mirrored forces and masses."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.model.assembly import forces, mass
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.model.state import Tow, mirrored
from trawl_ros.model.water import Water
from trawl_ros.records.observables import OBSERVABLES

FLIP = np.array([1.0, -1.0, 1.0])


def mirror_permutation(model: GearModel) -> np.ndarray:
    """Which node is the mirror image of which, from the layout and the net as built."""
    permutation = np.empty(model.nodes, int)
    for a, b in ((0, 1), (1, 0)):
        permutation[model.layout.warps[a]] = model.layout.warps[b]
    for a, b in ((0, 2), (1, 3), (2, 0), (3, 1)):
        permutation[model.layout.bridles[a]] = model.layout.bridles[b]
    net = model.layout.net
    built = model.first_guess[net]
    apart = np.linalg.norm(built[:, None] * FLIP - built[None], axis=2)
    assert apart.min(axis=1).max() < 1e-9
    permutation[net] = net[apart.argmin(axis=1)]
    return permutation


def mirrored_tow(tow: Tow) -> Tow:
    return Tow(
        (tow.blocks * FLIP)[::-1],
        (tow.block_velocities * FLIP)[::-1],
        tow.lengths[::-1],
        tow.length_rates[::-1],
    )


def mirrored_water(water: Water) -> Water:
    return replace(water, currents=water.currents * [1.0, -1.0])


def mirrored_bars(model: GearModel, permutation: np.ndarray) -> np.ndarray:
    """Number of the bar that is the mirror image of each bar.

    At a wing's edge a bar of netting and one of its rope join the same nodes, in this order.
    """
    n = model.nodes
    points = np.concatenate([permutation, n + np.array([3, 4, 5, 0, 1, 2]), n + np.array([7, 6])])
    numbers: dict[frozenset[int], list[int]] = {}
    for number, pair in enumerate(points[model.ends].tolist()):
        numbers.setdefault(frozenset(pair), []).append(number)
    return np.array([numbers[frozenset(pair)].pop(0) for pair in model.ends.tolist()])


def mirrored_vector(model: GearModel, vector: np.ndarray, permutation: np.ndarray) -> np.ndarray:
    """A generalised force or velocity, mirrored: moments and rates are axial vectors."""
    n = model.nodes
    nodes = (vector[: 3 * n].reshape(n, 3) * FLIP)[permutation]
    boards = (vector[3 * n :].reshape(2, 2, 3) * [FLIP, -FLIP])[::-1]
    return np.concatenate([nodes.ravel(), boards.ravel()])


@pytest.mark.parametrize('seed', [5, 6])
def test_forces_masses_and_observables_are_mirrored(
    model: GearModel, random_case, seed: int
) -> None:
    model, state, tow = random_case(model, seed)
    permutation = mirror_permutation(model)
    image = replace(
        model, water=mirrored_water(model.water), rest=model.rest[mirrored_bars(model, permutation)]
    )
    other, other_tow = mirrored(state, permutation), mirrored_tow(tow)

    force = forces(model, state, tow)
    expected = mirrored_vector(model, force, permutation)
    assert np.abs(forces(image, other, other_tow) - expected).max() < 1e-9 * np.abs(force).max()

    acceleration = np.random.default_rng(seed).normal(size=model.dof)
    inertia = model.pattern.matrix(mass(model, state, tow)) @ acceleration
    found = image.pattern.matrix(mass(image, other, other_tow)) @ mirrored_vector(
        model, acceleration, permutation
    )
    expected = mirrored_vector(model, inertia, permutation)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(inertia).max()

    seen = dict(zip(OBSERVABLES, observe(model, state, tow).array(), strict=True))
    there = dict(zip(OBSERVABLES, observe(image, other, other_tow).array(), strict=True))
    for name, value in seen.items():
        side, _, rest = name.partition('_')
        opposite = {'port': 'starboard', 'starboard': 'port'}.get(side)
        sign = -1.0 if rest == 'roll' else 1.0
        expected = sign * there[f'{opposite}_{rest}' if opposite else name]
        assert value == pytest.approx(expected, rel=1e-9, abs=1e-12), name


def test_the_net_as_built_is_its_own_mirror_image(model: GearModel) -> None:
    permutation = mirror_permutation(model)
    bars = mirrored_bars(model, permutation)
    for values in (model.rest, *vars(model.bars).values()):
        np.testing.assert_allclose(values[bars], values, rtol=1e-12)
    for lump in (model.lump_mass, model.lump_volume, model.lump_drag_area, model.lump_added):
        np.testing.assert_allclose(lump[permutation], lump, rtol=1e-12, atol=1e-15)
