"""The canvas kite (eq. 29-33), and knots, floats and weights on nodes (eq. 22, 28)."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.gear.records import FloatRecord
from trawl_ros.model import kite as kite_physics
from trawl_ros.model.assembly import forces, lump_forces
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.kite import Kite
from trawl_ros.model.water import Water

KITE = Kite(
    area=6.75,
    mass=50.0,
    volume=0.04,
    setting=np.radians(5.0),
    pitched=True,
    normal_slope=5.2,
    normal_limit=1.58,
    drag_base=0.1,
)
WATER = Water(density=1025.0)


def load(pitch: float, flow: tuple[float, float, float]) -> np.ndarray:
    """Load of a kite of a given pitch that moves against still water."""
    rear = np.array([0.0, 0.0, -80.0])
    front = rear + 3.0 * np.array([np.cos(pitch), 0.0, np.sin(pitch)])
    velocity = -np.array(flow)
    return kite_physics.load(KITE, front, rear, velocity, velocity, WATER)


@pytest.mark.parametrize('pitch', [-0.2, 0.0, 0.3])
def test_lift_acts_against_gravity_and_drag_along_the_flow(pitch: float) -> None:
    found = load(pitch, (-2.0, 0.0, 0.0))
    attack = pitch + np.radians(5.0)
    straight = 5.2 * np.sin(attack)
    normal = straight / (1 + (straight / 1.58) ** 4) ** 0.25
    pressure = 0.5 * 1025.0 * 6.75 * 4.0
    weight = (50.0 - 1025.0 * 0.04) * 9.80665
    np.testing.assert_allclose(
        found,
        [
            -pressure * (0.1 + normal * np.sin(attack)),
            0.0,
            pressure * normal * np.cos(attack) - weight,
        ],
        rtol=1e-12,
        atol=1e-9,
    )


def test_rising_water_raises_the_attack_angle_as_pitch_does() -> None:
    front, rear = np.array([3.0, 0.0, 0.0]), np.zeros(3)
    rising = kite_physics.attack_angle(KITE, front, rear, np.array([-2.0, 0.0, 2.0 * np.tan(0.1)]))
    front = 3.0 * np.array([np.cos(0.1), 0.0, np.sin(0.1)])
    pitched = kite_physics.attack_angle(KITE, front, rear, np.array([-2.0, 0.0, 0.0]))
    assert rising == pytest.approx(pitched) == pytest.approx(0.1 + np.radians(5.0))


def test_the_kite_lifts_whatever_the_course() -> None:
    turned = kite_physics.load(
        KITE,
        np.array([0.0, 3.0, -80.0]),
        np.array([0.0, 0.0, -80.0]),
        np.array([0.0, 2.0, 0.0]),
        np.array([0.0, 2.0, 0.0]),
        WATER,
    )
    np.testing.assert_allclose(turned[[1, 0, 2]], load(0.0, (-2.0, 0.0, 0.0)), atol=1e-9)


def test_the_headropes_centre_and_a_point_behind_it_share_the_kite(
    model: GearModel, random_case
) -> None:
    kite = model.gear.kite.model_copy(update={'chord_m': 24.0})
    model = build_model(model.gear.model_copy(update={'kite': kite}))
    model, state, tow = random_case(model, 11)
    bare = replace(model, kite=replace(model.kite, area=0.0, mass=0.0, volume=0.0))
    change = forces(model, state, tow) - forces(bare, state, tow)
    held = model.layout.kite
    carriers = held.weights @ state.nodes[held.nodes]
    motion = held.weights @ state.node_velocities[held.nodes]
    whole = kite_physics.load(model.kite, *carriers, *motion, model.water)
    nodes = change[: 3 * model.nodes].reshape(-1, 3)
    np.testing.assert_allclose(nodes.sum(axis=0), whole, rtol=1e-6, atol=1e-6)
    front, ahead, behind = held.nodes
    assert front == model.layout.headrope[len(model.layout.headrope) // 2]
    assert front == ahead
    # The point behind lies between two nodes: its half is shared by how near they are.
    share = held.weights[1, 2]
    assert 0.0 < share < 1.0
    np.testing.assert_allclose(nodes[front], whole * (1 - share / 2), rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(nodes[behind], whole * share / 2, rtol=1e-6, atol=1e-6)
    nodes[held.nodes] = 0.0
    assert np.abs(change[: 3 * model.nodes]).max() == 0.0


def test_a_kite_without_a_chord_keeps_its_setting_to_the_flow(
    model: GearModel, random_case
) -> None:
    model, state, _ = random_case(model, 11)
    held = model.layout.kite
    front, rear = held.weights @ state.nodes[held.nodes]
    np.testing.assert_array_equal(front, rear)
    level = kite_physics.attack_angle(model.kite, front, rear, np.array([-2.0, 0.5, 0.0]))
    assert level == pytest.approx(model.kite.setting)


def test_clumps_pull_down_and_floats_up_by_what_the_gear_file_says(model: GearModel) -> None:
    floats = FloatRecord(buoyancy_n=14000.0, density_kg_m3=300.0, drag_area_m2=1.4)
    model = build_model(model.gear.model_copy(update={'floats': floats}))
    bare = model.gear.model_copy(
        update={
            'clump': model.gear.clump.model_copy(update={'weight_in_water_n': 0.0}),
            'floats': model.gear.floats.model_copy(update={'buoyancy_n': 0.0}),
        }
    )
    without = build_model(bare)
    buoyant = (model.lump_mass - without.lump_mass) - 1025.0 * (
        model.lump_volume - without.lump_volume
    )
    weight = buoyant * model.water.gravity
    foot, head = model.layout.footrope, model.layout.headrope
    np.testing.assert_allclose(weight[[foot[0], foot[-1]]], model.gear.clump.weight_in_water_n)
    np.testing.assert_allclose(weight[[head[0], head[-1]]], -model.gear.floats.buoyancy_n)
    assert np.count_nonzero(np.abs(weight) > 1e-9) == 4


def test_a_lump_is_dragged_by_the_flow_and_weighed(model: GearModel, random_case) -> None:
    model, state, _ = random_case(model, 12)
    found = lump_forces(model, state)
    for k in (int(model.layout.footrope[0]), int(model.layout.net[40])):
        z = state.nodes[k, 2]
        density = model.water.density_at(z)
        flow = model.water.current(z) - state.node_velocities[k]
        speed = np.linalg.norm(flow)
        area = model.lump_drag_area[k] + model.lump_viscous_area[k] / np.sqrt(speed)
        expected = 0.5 * density * area * speed * flow
        expected[2] -= 9.80665 * (model.lump_mass[k] - density * model.lump_volume[k])
        np.testing.assert_allclose(found[k], expected, rtol=1e-9)
