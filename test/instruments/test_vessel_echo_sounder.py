"""The echo sounder reads the depth below the keel, and of the fish that pass through its beam."""

import math

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.echo_sounder import EchoSounder, cone
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import EchoSounderParameters, RangeParameters
from trawl_ros.instruments.sonar.schools import inside
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.water import Water
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import RangeSample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import SchoolTruth, SeabedTruth, Truth, VesselTruth
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.sea import School, Sea
from trawl_ros.simulation.seabed import Seabed
from trawl_ros.simulation.simulation import Simulation

DRAUGHT = 6.5
SEA = Surroundings(Water().pressure)


def sounder(
    *, assumed: float = 1485.0, surroundings: Surroundings = SEA, noise: float = 0.0
) -> EchoSounder:
    limits = {'min_range_m': 1.0, 'max_range_m': 800.0}
    parameters = EchoSounderParameters(
        assumed_sound_speed_m_s=assumed,
        beam_width_deg=7.0,
        depth=RangeParameters(rate_hz=1.0, noise_m=noise, **limits),
        school=RangeParameters(rate_hz=1.0, **limits),
    )
    return EchoSounder(parameters, DRAUGHT, surroundings, SeedPlan(seed=4))


def truth(
    heave: float = 0.0, seabed: float = math.inf, *schools: SchoolTruth, stamp: int = 0
) -> Truth:
    vessel = VesselTruth(np.array([100.0, 50.0, heave]), 0.0, 0.0, np.zeros(3), np.zeros(3))
    return partial_truth(stamp, vessel=vessel, schools=schools, seabed=SeabedTruth(seabed, seabed))


def school(east: float, north: float, depth: float, density: float = 1.0) -> SchoolTruth:
    return SchoolTruth(np.array([east, north, -depth]), np.array([60.0, 40.0, 20.0]), density)


def read(echo_sounder: EchoSounder, seen: Truth) -> dict[str, float]:
    samples = echo_sounder.observe(seen)
    assert all(isinstance(sample, RangeSample) for sample in samples)
    return {sample.what: sample.distance for sample in samples if isinstance(sample, RangeSample)}


def right(depth: float, heave: float = 0.0) -> float:
    """Give the speed that a sounder must assume to be right at a depth."""
    return SEA.mean_sound_speed(DRAUGHT - heave, depth)


@pytest.mark.parametrize('heave', [0.0, 1.5, -1.5])
def test_depth_is_from_the_keel_which_heaves_with_the_ship(heave: float) -> None:
    found = read(sounder(assumed=right(300.0, heave)), truth(heave, 300.0))
    assert found['depth'] == pytest.approx(300.0 - DRAUGHT + heave)


def test_depth_is_wrong_by_the_ratio_of_the_sound_speeds_along_the_way() -> None:
    warm_above = Surroundings(Water().pressure, ((0.0, 16.0), (60.0, 5.0), (400.0, 4.0)))
    found = read(sounder(assumed=1500.0, surroundings=warm_above), truth(0.0, 300.0))
    mean = warm_above.mean_sound_speed(DRAUGHT, 300.0)
    assert found['depth'] == pytest.approx((300.0 - DRAUGHT) * 1500.0 / mean)
    assert found['depth'] - (300.0 - DRAUGHT) > 2.0


def test_a_bottom_out_of_reach_and_no_bottom_at_all_are_infinite() -> None:
    assert read(sounder(), truth(0.0, 1000.0))['depth'] == math.inf
    assert read(sounder(), truth())['depth'] == math.inf


def test_depth_errs_by_what_is_stated() -> None:
    noisy = sounder(assumed=right(300.0), noise=0.4)
    samples = [noisy.observe(truth(0.0, 300.0, stamp=k * SECOND))[0] for k in range(2000)]
    depths = [sample.distance for sample in samples if isinstance(sample, RangeSample)]
    assert np.std(depths) == pytest.approx(0.4, rel=0.05)
    assert np.mean(depths) == pytest.approx(300.0 - DRAUGHT, abs=0.03)
    assert {sample.std for sample in samples if isinstance(sample, RangeSample)} == {0.4}


def test_fish_under_the_keel_are_read_at_their_upper_edge() -> None:
    right_there = school(100.0, 50.0, 90.0)
    found = read(sounder(assumed=right(80.0)), truth(0.0, 300.0, right_there))
    assert found['school'] == pytest.approx(90.0 - 10.0 - DRAUGHT)
    assert read(sounder(), truth(0.0, 300.0))['school'] == math.inf


def test_the_uppermost_of_several_schools_counts_and_none_below_the_seabed() -> None:
    both = school(100.0, 50.0, 200.0), school(110.0, 50.0, 120.0)
    found = read(sounder(assumed=right(110.0)), truth(0.0, 300.0, *both))
    assert found['school'] == pytest.approx(120.0 - 10.0 - DRAUGHT, abs=1.0)
    buried = school(100.0, 50.0, 320.0)
    assert read(sounder(), truth(0.0, 300.0, buried))['school'] == math.inf


@pytest.mark.parametrize(('side', 'seen'), [(33.0, True), (37.0, False)])
def test_only_fish_in_the_cone_are_seen(side: float, seen: bool) -> None:
    # At 90 m the beam reaches 5.1 m to the side, the school 30 m.
    found = read(sounder(), truth(0.0, 300.0, school(100.0 + side, 50.0, 90.0)))
    assert math.isfinite(found['school']) == seen


def test_fish_all_around_the_keel_are_nearer_than_it_can_tell() -> None:
    around = SchoolTruth(np.array([100.0, 50.0, -10.0]), np.full(3, 19.0), 1.0)
    assert read(sounder(), truth(0.0, 300.0, around))['school'] == -math.inf


def test_rays_fill_the_cone_and_no_more() -> None:
    rays = cone(math.radians(3.5))
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1.0)
    tilts = np.degrees(np.arccos(-rays[:, 2]))
    assert tilts.max() == pytest.approx(3.5)
    assert np.abs(rays.mean(0)[:2]).max() < 1e-12


def test_lines_meet_an_ellipsoid_where_its_surface_is() -> None:
    fish = school(0.0, 0.0, 100.0)
    ways = np.random.default_rng(2).normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    origin = np.array([10.0, 5.0, -70.0])
    near, far = inside(fish, origin, ways)
    met = np.isfinite(near)
    assert 20 < met.sum() < 180
    for distances in (near[met], far[met]):
        points = origin + distances[:, None] * ways[met] - fish.position
        np.testing.assert_allclose(((2 * points / fish.size) ** 2).sum(1), 1.0)
    along = np.linspace(-200.0, 200.0, 4001)[:, None]
    for way in ways[~met]:
        points = origin + along * way - fish.position
        assert ((2 * points / fish.size) ** 2).sum(1).min() > 0.999


def test_a_school_passes_under_the_ship_when_she_reaches_it(model: GearModel) -> None:
    speed, begin = 2.1, 40.0
    fish = School(np.array([begin, 0.0, -90.0]), np.array([50.0, 40.0, 20.0]), 1.0, np.zeros(3))
    sea = Sea(seabed=Seabed(depths=np.array([300.0])), schools=(fish,))
    tow = Simulation(model, Command(500.0, 500.0, speed), period=0.5, sea=sea)
    echo_sounder = sounder()
    seen, depths = [], set()
    for _ in range(80):
        tow.advance()
        found = read(echo_sounder, tow.truth())
        if not found:
            continue
        depths.add(round(found['depth'], 6))
        if math.isfinite(found['school']):
            seen.append(tow.now.stamp / SECOND)
    # The beam, 5 m to either side where the school is widest, comes to its edges.
    wide = 25.0 + (90.0 - DRAUGHT) * math.tan(math.radians(3.5))
    assert seen[0] == pytest.approx((begin - wide) / speed, abs=2.0)
    assert seen[-1] == pytest.approx((begin + wide) / speed, abs=2.0)
    assert np.diff(seen).max() <= 1.0 + 1e-9
    assert len(depths) == 1
