"""Each instrument reports its own quantity in the contract's signs and units."""

import math

import numpy as np
import pytest

from trawl_ros.core.geodesy import Datum, to_latitude_longitude
from trawl_ros.core.time import SECOND
from trawl_ros.instruments.distance import RangeInstrument
from trawl_ros.instruments.doors import DoorAttitude, DoorSpread, door_tilt
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.errors.records import ForceErrors, LengthErrors, SpeedErrors, TurnErrors
from trawl_ros.instruments.parameters import (
    AngleParameters,
    LengthParameters,
    PressureParameters,
    RangeParameters,
    SpreadParameters,
    VelocityParameters,
    WinchParameters,
)
from trawl_ros.instruments.pressure import PressureInstrument
from trawl_ros.instruments.vessel import GpsFix, GpsVelocity, Heading, SpeedLog
from trawl_ros.instruments.winch import WinchInstrument
from trawl_ros.model.water import Water
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import DoorTruth, WinchTruth

DRAWS = SeedPlan(seed=4)
SEA = Surroundings(Water().pressure)
LIMITS = {'min_range_m': 5.0, 'max_range_m': 400.0}


def door(y: float, z: float) -> DoorTruth:
    nothing, level = np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0])
    return DoorTruth(np.array([0.0, y, z]), level, nothing, nothing, 0, 0, 0, nothing, nothing)


def turn(axis: str, angle: float) -> np.ndarray:
    quaternion = np.zeros(4)
    quaternion['xyz'.index(axis)], quaternion[3] = math.sin(angle / 2), math.cos(angle / 2)
    return quaternion


def after(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Give the product a b: first b, then a, about fixed axes."""
    av, bv = a[:3], b[:3]
    return np.append(a[3] * bv + b[3] * av + np.cross(av, bv), a[3] * b[3] - av @ bv)


def test_a_winch_sample_has_both_sides_with_errors_of_their_own() -> None:
    parameters = WinchParameters(
        rate_hz=2.0,
        length=LengthErrors(noise_m=0.5),
        speed=SpeedErrors(),
        tension=ForceErrors(resolution_kn=0.1),
    )
    winches = (WinchTruth(500.0, 0.5, 160_049.0), WinchTruth(510.0, -0.5, 150_051.0))
    (sample,) = WinchInstrument(parameters, DRAWS).observe(winches, 7)
    assert sample.stamp == 7
    assert sample.speeds == (0.5, -0.5)
    assert sample.tensions == pytest.approx((160_000.0, 150_100.0))
    assert sample.lengths == pytest.approx((500.0, 510.0), abs=3.0)
    assert sample.lengths[0] - 500.0 != sample.lengths[1] - 510.0


def test_door_pressure_is_absolute_and_follows_the_density_of_the_water() -> None:
    water = Water(density=1026.0, density_gradient=0.005)
    sensor = PressureInstrument(
        'door/port/pressure', 'port', PressureParameters(rate_hz=1.0), water.pressure, DRAWS
    )
    (sample,) = sensor.observe(200.0, 0)
    assert (sample.place, sample.std) == ('port', 0.0)
    expected = 101_325 + 9.80665 * (1026.0 * 200 + 0.005 * 200**2 / 2)
    assert sample.pressure == pytest.approx(expected, rel=1e-12)


def test_a_pressure_sensor_out_of_the_water_reads_the_air() -> None:
    parameters = PressureParameters(rate_hz=1.0)
    sensor = PressureInstrument('sonar/pressure', 'sonar', parameters, Water().pressure, DRAWS)
    (above,) = sensor.observe(-3.0, 0)
    (unknown,) = sensor.observe(math.nan, SECOND)
    assert above.pressure == 101_325.0
    assert math.isnan(unknown.pressure)


@pytest.mark.parametrize('heading', [0.0, 1.0, -2.5])
def test_pitch_is_nose_down_and_roll_is_top_to_starboard_on_any_heading(heading: float) -> None:
    yawed = turn('z', heading)
    pitched = after(yawed, turn('y', 0.2))
    assert door_tilt(pitched) == pytest.approx((0.2, 0.0))
    leaning = after(yawed, turn('x', 0.3))
    assert door_tilt(leaning) == pytest.approx((0.0, 0.3))
    both = after(pitched, turn('x', 0.3))
    assert door_tilt(both) == pytest.approx((0.2, 0.3))
    # The claims about nose and top, in the world's own coordinates.
    x, y, z, w = pitched
    assert 2 * (x * z - w * y) < 0  # the nose points down
    x, y, z, w = after(turn('z', 0.0), turn('x', 0.3))
    assert 2 * (y * z - w * x) < 0  # the top points to starboard, which is -y


def test_attitude_errs_by_the_stated_amount() -> None:
    sensor = DoorAttitude('starboard', AngleParameters(rate_hz=1.0, noise_deg=0.5), DRAWS)
    samples = [s for k in range(4000) for s in sensor.observe(turn('y', 0.1), k * SECOND)]
    pitches = np.array([s.pitch for s in samples])
    assert (samples[0].side, samples[0].std) == ('starboard', pytest.approx(math.radians(0.5)))
    assert pitches.mean() == pytest.approx(0.1, abs=1e-3)
    assert pitches.std() == pytest.approx(math.radians(0.5), rel=0.05)


def test_spread_is_the_distance_between_the_doors() -> None:
    sensor = DoorSpread(SpreadParameters(rate_hz=0.5, **LIMITS), SEA, DRAWS)
    (sample,) = sensor.observe((door(60.0, -99.0), door(-60.0, -104.0)), 0)
    assert (sample.what, sample.min_range, sample.max_range) == ('spread', 5.0, 400.0)
    assert sample.distance == pytest.approx(math.hypot(120.0, 5.0))


def test_a_distance_out_of_range_is_infinite() -> None:
    parameters = RangeParameters(rate_hz=1.0, **LIMITS)
    sensor = RangeInstrument('sonar/bottom', 'bottom', parameters, DRAWS)
    readings = [r for k, d in enumerate((4.0, 5.0, 401.0)) for r in sensor.observe(d, k * SECOND)]
    assert [r.distance for r in readings] == [-math.inf, 5.0, math.inf]


def test_log_and_gps_report_their_own_velocity() -> None:
    parameters = VelocityParameters(rate_hz=1.0, velocity=SpeedErrors(), yaw_rate=TurnErrors())
    truth = np.array([2.0, -0.1, 0.3]), 0.01
    for sensor, over in (
        (SpeedLog(parameters, DRAWS), 'water'),
        (GpsVelocity(parameters, DRAWS), 'ground'),
    ):
        (sample,) = sensor.observe(truth, 0)
        assert (sample.over, sample.yaw_rate) == (over, 0.01)
        assert sample.velocity == pytest.approx([2.0, -0.1, 0.0])


def test_heading_stays_within_half_a_turn() -> None:
    sensor = Heading(AngleParameters(rate_hz=1.0), DRAWS)
    (sample,) = sensor.observe(math.radians(350.0), 0)
    assert sample.heading == pytest.approx(math.radians(-10.0))


def test_one_minute_of_latitude_is_the_meridian_arc_of_the_ellipsoid() -> None:
    # Arc from 59° 30' to 60° 30' on WGS 84, m, by the series for the meridian distance.
    a, e2 = 6_378_137.0, 0.006_694_379_990_14
    lats = np.radians(np.linspace(59.5, 60.5, 2001))
    radius = a * (1 - e2) / (1 - e2 * np.sin(lats) ** 2) ** 1.5
    arc = float(np.sum((radius[1:] + radius[:-1]) / 2 * np.diff(lats)))
    south, _ = to_latitude_longitude(np.array([0.0, -1000.0, 0.0]), Datum(60.0, 2.0))
    north, _ = to_latitude_longitude(np.array([0.0, 1000.0, 0.0]), Datum(60.0, 2.0))
    assert (north - south) * arc == pytest.approx(2000.0, abs=0.001)


@pytest.mark.parametrize('datum', [Datum(60.0, 2.0), Datum(-33.0, 179.99), Datum(0.0, -75.0)])
@pytest.mark.parametrize('place', [(0.0, 0.0, 0.0), (5000.0, -3000.0, 0.0), (-40e3, 30e3, 10.0)])
def test_a_position_comes_back_through_geocentric_coordinates(
    datum: Datum, place: tuple[float, float, float]
) -> None:
    def axes(lat: float, lon: float) -> tuple[np.ndarray, np.ndarray]:
        """Give the point of the ellipsoid, and its east, north, up as rows."""
        a, e2 = 6_378_137.0, (2 - 1 / 298.257_223_563) / 298.257_223_563
        n = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
        up = np.array([math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)])
        east = np.array([-math.sin(lon), math.cos(lon), 0.0])
        return n * up - np.array([0, 0, n * e2 * math.sin(lat)]), np.array(
            [east, np.cross(up, east), up]
        )

    origin, enu = axes(math.radians(datum.latitude), math.radians(datum.longitude))
    lat, lon = to_latitude_longitude(np.array(place), datum)
    point, there = axes(math.radians(lat), math.radians(lon))
    # The position lies straight above (or below) the point that was found.
    offset = there @ (origin + enu.T @ np.array(place) - point)
    assert offset[:2] == pytest.approx([0.0, 0.0], abs=1e-4)
    assert -180.0 <= lon <= 180.0


def test_a_fix_errs_by_metres_on_the_ground() -> None:
    sensor = GpsFix(LengthParameters(rate_hz=1.0, noise_m=2.0), Datum(60.0, 2.0), DRAWS)
    fixes = [fix for k in range(3000) for fix in sensor.observe(np.zeros(3), k * SECOND)]
    east = np.array([(f.longitude - 2.0) * 55_800.0 for f in fixes])
    assert east.std() == pytest.approx(2.0, rel=0.05)
    assert fixes[0].std == 2.0


def test_the_stated_noise_may_differ_from_the_true_one() -> None:
    assert LengthErrors(noise_m=3.0, resolution_m=1.2).model().stated_std == pytest.approx(
        math.sqrt(9.0 + 0.12)
    )
    model = ForceErrors(noise_kn=2.0, stated_std_kn=1.0).model()
    assert (model.white.std, model.stated_std) == (2000.0, 1000.0)


def test_units_of_the_file_become_si() -> None:
    errors = TurnErrors(
        noise_deg_s=180.0,
        correlated_deg_s=90.0,
        correlation_time_s=7.0,
        bias_per_state_deg_s=18.0,
        resolution_deg_s=1.8,
        stated_std_deg_s=36.0,
        offset_deg_s=-90.0,
        drift_deg_s_per_hour=1.0,
        lowest_deg_s=-180.0,
        highest_deg_s=180.0,
    )
    pi = math.pi
    found = errors.model()
    assert (found.white.std, found.correlated_std) == pytest.approx((pi, pi / 2))
    assert (found.correlation_time, found.bias_std) == pytest.approx((7.0, pi / 10))
    assert (found.resolution, found.stated_std) == pytest.approx((pi / 100, pi / 5))
    assert (found.offset, found.drift) == pytest.approx((-pi / 2, pi / 180))
    assert (found.lowest, found.highest) == pytest.approx((-pi, pi))
