"""The fish sonar shows schools ahead where they are, within its errors, and misses faint ones."""

import math

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.fish_sonar import FishSonar
from trawl_ros.instruments.parameters import FishSonarParameters, load_instruments
from trawl_ros.instruments.vessel import VesselInstruments
from trawl_ros.model.water import Water
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import VelocitySample
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import SchoolTruth, VesselTruth

DRAUGHT = 6.5
SEA = Surroundings(Water().pressure)
DEFAULT = load_instruments().vessel.fish_sonar
EXACT = DEFAULT.model_copy(
    update={
        'assumed_sound_speed_m_s': SEA.mean_sound_speed(DRAUGHT, 60.0),
        'half_seen_db': -300.0,
        'range': DEFAULT.range.model_copy(update={'noise_m': 0.0, 'resolution_m': 0.0}),
        'bearing': DEFAULT.bearing.model_copy(update={'noise_deg': 0.0, 'resolution_deg': 0.0}),
        'tilt': DEFAULT.tilt.model_copy(update={'noise_deg': 0.0, 'resolution_deg': 0.0}),
    }
)
"""A sonar without errors that misses nothing in its beam."""


def sonar(parameters: FishSonarParameters = EXACT, seed: int = 4) -> FishSonar:
    return FishSonar(parameters, DRAUGHT, SEA, SeedPlan(seed=seed))


def ship(heading: float = 0.0, east: float = 0.0, north: float = 0.0) -> VesselTruth:
    return VesselTruth(np.array([east, north, 0.0]), heading, 0.0, np.zeros(3), np.zeros(3))


def school(east: float, north: float, depth: float = 60.0, density: float = 1.0) -> SchoolTruth:
    return SchoolTruth(np.array([east, north, -depth]), np.array([60.0, 60.0, 20.0]), density)


def sweeps(of: FishSonar, vessel: VesselTruth, *schools: SchoolTruth, count: int = 1) -> np.ndarray:
    """Positions (n, 3) of all schools seen in some sweeps."""
    seen = []
    for k in range(count):
        (sample,) = of.observe((vessel, schools), 10 * k * SECOND)
        seen += sample.positions.tolist()
    return np.array(seen).reshape(-1, 3)


def test_a_school_is_placed_in_the_ships_frame_on_any_heading() -> None:
    # 600 m ahead and 200 m to port of a ship that steams north.
    north = ship(math.pi / 2, east=50.0, north=-30.0)
    (found,) = sweeps(sonar(), north, school(50.0 - 200.0, -30.0 + 600.0))
    np.testing.assert_allclose(found, [600.0, 200.0, -60.0], atol=1e-6)


def test_there_is_one_sample_per_sweep_empty_where_nothing_is() -> None:
    one = sonar()
    samples = [sample for k in range(601) for sample in one.observe((ship(), ()), k * SECOND // 10)]
    assert [sample.stamp for sample in samples] == [10 * k * SECOND for k in range(7)]
    assert {sample.positions.shape for sample in samples} == {(0, 3)}


@pytest.mark.parametrize(
    ('place', 'seen'),
    [
        (school(1450.0, 0.0), True),
        (school(1550.0, 0.0), False),
        (school(30.0, 0.0, 10.0), False),
        (school(100.0, 800.0), True),
        (school(-100.0, 800.0), False),
        # The beam ends 10° down; at 300 m a school at 60 m just reaches into it, at 200 m not.
        (school(300.0, 0.0), True),
        (school(200.0, 0.0), False),
    ],
    ids=['near', 'far', 'too near', 'abeam', 'astern', 'edge of beam', 'under the beam'],
)
def test_what_is_out_of_range_sector_or_beam_is_not_seen(place: SchoolTruth, seen: bool) -> None:
    assert len(sweeps(sonar(), ship(), place)) == seen


def test_positions_are_right_within_the_stated_errors() -> None:
    # On the bow, so that errors of bearing turn into both x and y.
    place = school(500.0, 500.0)
    found = sweeps(sonar(DEFAULT), ship(), place, count=2000)
    assert len(found) > 1900
    ranges = np.linalg.norm(found - [0.0, 0.0, -DRAUGHT], axis=1)
    bearings = np.degrees(np.arctan2(found[:, 1], found[:, 0]))
    tilts = np.degrees(np.arcsin(-(found[:, 2] + DRAUGHT) / ranges))
    distance = math.hypot(500.0, 500.0, 60.0 - DRAUGHT)
    assert ranges.std() == pytest.approx(10.0, rel=0.06)
    assert bearings.std() == pytest.approx(1.5, rel=0.06)
    assert tilts.std() == pytest.approx(2.0, rel=0.06)
    # Set to 1500 m/s in water of 1482 m/s, it shows everything too far away.
    stretch = DEFAULT.assumed_sound_speed_m_s / SEA.mean_sound_speed(DRAUGHT, 60.0)
    assert ranges.mean() == pytest.approx(distance * stretch, abs=1.0)
    assert ranges.mean() - distance > 5.0
    assert bearings.mean() == pytest.approx(45.0, abs=0.15)
    down = math.degrees(math.asin((60.0 - DRAUGHT) / distance))
    assert tilts.mean() == pytest.approx(down, abs=0.2)


def test_far_and_thin_schools_are_missed_as_often_as_their_echo_level_says() -> None:
    for place in (school(1000.0, 0.0), school(1300.0, 0.0), school(1000.0, 0.0, density=0.05)):
        one = sonar(DEFAULT)
        distance = float(np.linalg.norm(place.position + [0.0, 0.0, DRAUGHT]))
        excess = one.echo_level(place, distance, DRAUGHT) - DEFAULT.half_seen_db
        expected = 1 / (1 + math.exp(-excess / DEFAULT.fading_db))
        assert 0.02 < expected < 0.99
        share = len(sweeps(one, ship(), place, count=2000)) / 2000
        assert share == pytest.approx(expected, abs=0.03)


def test_the_echo_level_follows_the_sonar_equation() -> None:
    one = sonar(DEFAULT)
    near, far = one.echo_level(school(0, 0), 500.0, 5.0), one.echo_level(school(0, 0), 1000.0, 5.0)
    # 12 dB of spreading, and 26 kHz lose 5 to 7 dB per km in water of 8 °C.
    assert 12.04 + 5.0 < near - far < 12.04 + 7.0
    denser = one.echo_level(school(0, 0, density=10.0), 500.0, 5.0)
    assert denser - near == pytest.approx(10.0)
    fish = math.pi / 6 * 60 * 60 * 20
    at_one_metre = one.echo_level(school(0, 0), 1.0, 5.0)
    assert at_one_metre == pytest.approx(-42.0 + 10 * math.log10(fish), abs=0.02)


def test_schools_come_by_range_and_carry_no_name() -> None:
    near, far = school(500.0, 100.0), school(900.0, -100.0)
    one = sweeps(sonar(), ship(), far, near)
    np.testing.assert_array_equal(one, sweeps(sonar(), ship(), near, far))
    assert one[:, 0].tolist() == sorted(one[:, 0])


def test_one_more_school_changes_nothing_for_those_before_it() -> None:
    first, second = school(800.0, 100.0), school(5000.0, 0.0)
    alone = sweeps(sonar(DEFAULT), ship(), first, count=1)
    np.testing.assert_array_equal(alone, sweeps(sonar(DEFAULT), ship(), first, second, count=1))


def test_it_begins_again_when_time_is_set_back() -> None:
    one = sonar(DEFAULT)
    place = school(1200.0, 0.0)
    first = sweeps(one, ship(), place, count=50)
    assert 5 < len(first) < 50
    np.testing.assert_array_equal(first, sweeps(one, ship(), place, count=50))


def test_a_cross_current_shows_as_the_difference_of_ground_and_water() -> None:
    parameters = load_instruments().vessel
    boat = VesselInstruments(parameters, SeedPlan(seed=1), surroundings=SEA)
    current = np.array([0.1, 0.4, 0.0])
    heading = 0.5
    ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
    vessel = VesselTruth(
        np.zeros(3), heading, 0.0, 2.1 * ahead + current, np.array([2.1, 0.0, 0.0])
    )
    water, ground = [], []
    for k in range(900):
        for sample in boat.observe(partial_truth(k * SECOND, vessel=vessel)):
            match sample:
                case VelocitySample(over='water'):
                    water.append(sample.velocity)
                case VelocitySample(over='ground'):
                    ground.append(sample.velocity)
    x, y, _ = np.mean(water, axis=0)
    through = np.array([x * ahead[0] - y * ahead[1], x * ahead[1] + y * ahead[0]])
    difference = np.mean(ground, axis=0)[:2] - through
    np.testing.assert_allclose(difference, current[:2], atol=0.01)
