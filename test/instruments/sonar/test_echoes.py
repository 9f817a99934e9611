"""The sonar equation, piece by piece: where echoes land, how strong they are, how they scatter."""

import math

import numpy as np
import pytest

from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.instruments.sonar.absorption import absorption
from trawl_ros.instruments.sonar.echoes import Beam, Ping, Sounding, echoes, rope_cross_section
from trawl_ros.instruments.sonar.image import Grid
from trawl_ros.instruments.sonar.screen import Interference, Receiver, heard, interfering, speckled
from trawl_ros.records.truth import SchoolTruth

RECORD = load_instruments().sonar.sweep
GRID = RECORD.grid()
BEAM = RECORD.beam(1485.0)
STRENGTHS = RECORD.strengths()
SOUNDING = Sounding(stretch=1.0, pulse=0.3)


def polar(*places: tuple[float, float]) -> np.ndarray:
    """A section (k, 3) of ropes of 3 cm at ranges (m) and angles (rad)."""
    rows = [[r * math.cos(angle), r * math.sin(angle), 0.03] for r, angle in places]
    return np.array(rows).reshape(-1, 3)


def ping(
    angle: float,
    section: np.ndarray,
    schools: tuple[SchoolTruth, ...] = (),
    altitude: float = math.inf,
) -> Ping:
    """A ping of a sonar that looks east from 100 m of depth."""
    axes = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    return Ping(angle, np.array([0.0, 0.0, -100.0]), axes, section, schools, altitude)


def received(pings: list[Ping], sounding: Sounding = SOUNDING, seed: int = 0) -> np.ndarray:
    generator = np.random.default_rng(seed)
    return echoes(pings, GRID, BEAM, STRENGTHS, sounding, generator)


def all_around(section: np.ndarray, altitude: float = math.inf) -> list[Ping]:
    return [ping(float(angle), section, altitude=altitude) for angle in GRID.angles]


def francois_garrison(f: float, t: float, s: float, d: float) -> float:
    """Absorption (dB/km) at f (kHz), t (°C up to 20), s, d (m), pH 8: the formula of 1982."""
    c, kelvin = 1412 + 3.21 * t + 1.19 * s + 0.0167 * d, t + 273
    f1 = 2.8 * math.sqrt(s / 35) * 10 ** (4 - 1245 / kelvin)
    f2 = 8.17 * 10 ** (8 - 1990 / kelvin) / (1 + 0.0018 * (s - 35))
    a1, a2 = 8.86 / c * 10 ** (0.78 * 8 - 5), 21.44 * s / c * (1 + 0.025 * t)
    a3 = 4.937e-4 - 2.59e-5 * t + 9.11e-7 * t**2 - 1.50e-8 * t**3
    p2, p3 = 1 - 1.37e-4 * d + 6.2e-9 * d**2, 1 - 3.83e-5 * d + 4.9e-10 * d**2
    return a1 * f1 * f**2 / (f1**2 + f**2) + a2 * p2 * f2 * f**2 / (f2**2 + f**2) + a3 * p3 * f**2


@pytest.mark.parametrize('kilohertz', [38.0, 120.0, 200.0, 330.0])
@pytest.mark.parametrize(('celsius', 'depth'), [(2.0, 0.0), (8.0, 100.0), (16.0, 400.0)])
def test_absorption_is_within_ten_per_cent_of_the_older_formula(
    kilohertz: float, celsius: float, depth: float
) -> None:
    expected = francois_garrison(kilohertz, celsius, 35.0, depth)
    found = 1e3 * absorption(1e3 * kilohertz, celsius, 35.0, depth)
    assert found == pytest.approx(expected, rel=0.10)


@pytest.mark.parametrize(('row', 'away'), [(5, 20.1), (40, 64.9), (71, 43.3)])
def test_a_rope_lands_in_the_row_and_column_of_its_angle_and_range(row: int, away: float) -> None:
    image = received(all_around(polar((away, float(GRID.angles[row])))))
    found_row, column = np.unravel_index(np.argmax(image), image.shape)
    assert found_row == row
    assert GRID.ranges[column] == pytest.approx(away, abs=GRID.cell)
    # Positive angles are to port, and down is in the middle of the sector.
    half = math.radians(0.5 * RECORD.sector_deg)
    assert [GRID.angles[0], GRID.angles[-1]] == pytest.approx([-half, half])


def test_a_wrong_speed_of_sound_stretches_ranges() -> None:
    image = received(all_around(polar((50.0, 0.0))), Sounding(1.02, 0.3))
    assert GRID.ranges[np.argmax(image.max(axis=0))] == pytest.approx(51.0, abs=GRID.cell)


def test_a_beam_is_as_wide_as_said_with_the_side_lobes_of_a_line() -> None:
    beam = Beam(math.radians(4.0), math.radians(4.0), 0.0045)
    assert beam.two_way(np.array([0.0, math.radians(2.0)])) == pytest.approx([1.0, 0.25])
    off = np.radians(np.linspace(4.6, 8.5, 400))
    assert 10 * np.log10(beam.two_way(off).max()) == pytest.approx(-26.5, abs=0.1)
    assert beam.two_way(np.array([math.pi])) == 0.0


def test_an_echo_is_as_long_as_the_pulse_and_as_strong_as_the_rope() -> None:
    away = float(GRID.ranges[200])
    pulse = 5 * GRID.cell
    row = received([ping(0.0, polar((away, 0.0)))] * GRID.beams, Sounding(1.0, pulse))[0]
    strength = rope_cross_section(np.array([0.03]), np.array([away]), BEAM, STRENGTHS)[0]
    assert row.max() == pytest.approx(strength)
    assert (row >= 0.5 * strength).sum() == 5


def test_the_echo_of_a_rope_grows_with_its_diameter_and_of_thin_twine_much_faster() -> None:
    beam = Beam(0.04, 0.04, 0.0045)

    def ratio(diameter: float) -> float:
        pair = np.array([diameter, 2 * diameter])
        thin, thick = rope_cross_section(pair, np.array([30.0]), beam, STRENGTHS)
        return float(thick / thin)

    assert ratio(0.05) == pytest.approx(2.0, rel=0.01)
    assert ratio(0.0001) == pytest.approx(16.0, rel=0.01)
    at_once = rope_cross_section(np.array([0.05]), np.array([30.0, 60.0]), beam, STRENGTHS)
    assert at_once[1] / at_once[0] == pytest.approx(2.0)


RECEIVER = Receiver(200.0, 60.0, 0.08, -60.0, -20.0)


def test_time_varied_gain_keeps_a_point_as_strong_at_any_range() -> None:
    quiet = Receiver(200.0, -300.0, 0.08, -60.0, -20.0)
    level = heard(np.ones((1, GRID.cells)), GRID, quiet, 0.08, 1.0)
    np.testing.assert_allclose(level, 1.0, rtol=1e-9)


def test_what_the_gain_does_not_know_of_absorption_is_missing() -> None:
    naive = Receiver(200.0, -300.0, 0.0, -60.0, -20.0)
    level = 10 * np.log10(heard(np.ones((1, GRID.cells)), GRID, naive, 0.08, 1.0)[0])
    np.testing.assert_allclose(level, -2 * 0.08 * GRID.ranges, atol=1e-9)


def test_noise_grows_with_the_gain_put_on_it() -> None:
    noise = 10 * np.log10(heard(np.zeros((1, GRID.cells)), GRID, RECEIVER, 0.08, 1.0)[0])
    ranges = GRID.ranges
    expected = 60.0 - 200.0 + 40 * np.log10(ranges) + 2 * 0.08 * ranges
    np.testing.assert_allclose(noise, expected, atol=1e-9)


def test_brightness_is_linear_in_decibels_between_black_and_white() -> None:
    levels = 10 ** (np.array([-80.0, -60.0, -40.0, -20.0, 0.0]) / 10)
    assert RECEIVER.brightness(levels, 0.0).tolist() == [0, 0, 128, 255, 255]
    assert RECEIVER.brightness(levels, 4.0).tolist() == [0, 26, 153, 255, 255]
    assert RECEIVER.brightness(np.zeros(1), 0.0).tolist() == [0]


def test_speckle_is_rayleigh_in_amplitude_and_keeps_the_mean() -> None:
    amplitude = np.sqrt(speckled(np.full((200, 500), 4.0), np.random.default_rng(1)))
    assert np.mean(amplitude**2) == pytest.approx(4.0, rel=0.02)
    assert amplitude.mean() / amplitude.std() == pytest.approx(
        math.sqrt(math.pi / (4 - math.pi)), rel=0.02
    )


def test_fish_are_as_many_as_density_and_volume_make_them() -> None:
    school = SchoolTruth(np.array([0.0, 0.0, -140.0]), np.array([4000.0, 4000.0, 40.0]), 0.5)
    # One beam of the fan alone: what others see of its fish is left out.
    narrow = Beam(1e-4, BEAM.thickness, BEAM.wave_length)
    alone = Sounding(1.0, 1e-3)
    drawn = np.array(
        [
            echoes([ping(float(a), polar(), (school,)) for a in GRID.angles], GRID, narrow,
                   STRENGTHS, alone, np.random.default_rng(seed))[40]
            for seed in range(300)
        ]
    )  # fmt: skip
    fish = drawn / STRENGTHS.fish
    cells = (GRID.ranges > 21.0) & (GRID.ranges < 59.0)
    volume = GRID.cell * GRID.ranges**2 * GRID.angle_increment * BEAM.thickness
    expected = 0.5 * volume[cells]
    np.testing.assert_allclose(fish[:, cells].sum(axis=1).mean(), expected.sum(), rtol=0.02)
    # Whole fish, and as many more or less as chance makes of independent ones.
    assert fish[:, cells] == pytest.approx(np.round(fish[:, cells]), abs=1e-9)
    np.testing.assert_allclose(fish[:, cells].var(axis=0).mean(), expected.mean(), rtol=0.05)
    outside = (GRID.ranges < 19.5) | (GRID.ranges > 60.5)
    assert fish[:, outside].max() < 1e-9


def test_the_seabed_is_a_line_across_the_beams_strongest_right_below() -> None:
    image = received(all_around(polar(), altitude=60.0))
    for row in np.flatnonzero(np.abs(GRID.angles) < math.radians(30.0)):
        away = GRID.ranges[np.argmax(image[row])]
        spread = 60.0 * abs(math.tan(GRID.angles[row])) * BEAM.width
        assert away == pytest.approx(60.0 / math.cos(GRID.angles[row]), abs=0.3 + spread)
    assert abs(GRID.angles[np.argmax(image.max(axis=1))]) < math.radians(5.0)
    assert not received(all_around(polar(), altitude=GRID.max_range + 5.0)).any()


def test_the_seabed_below_scatters_as_its_patch_in_the_beam() -> None:
    """All that comes back from below is strength times area, h² times the beam's solid angle."""
    narrow = Beam(0.02, 0.03, 0.0045)
    single = Sounding(1.0, 1e-3)
    generator = np.random.default_rng(0)
    fine = Grid(1, 4500, 0.0, 0.0004, 1.0, 90.0, 40.0)
    total = echoes([ping(0.0, polar(), altitude=60.0)], fine, narrow, STRENGTHS, single, generator)
    angles = np.linspace(-0.2, 0.2, 4001)
    ideal_width = float(narrow.two_way(angles).sum() * (angles[1] - angles[0]))
    expected = STRENGTHS.seabed * 60.0**2 * ideal_width * narrow.thickness
    assert total.sum() == pytest.approx(expected, rel=0.02)


def test_another_sonar_leaves_dots_that_wander_by_what_the_periods_differ() -> None:
    other = Interference(period=0.5, length=1e-4, level=100.0)
    times = 1000.0 + 0.25 * np.arange(GRID.beams)
    dots = interfering(times, GRID, RECEIVER, other, 1500.0)
    lit = dots > 0
    # Two pings per pulse: one beam in two has it, always at the range of its arrival.
    assert set(np.flatnonzero(lit.any(axis=1)) % 2) == {0}
    assert (lit.sum(axis=1)[::2] <= 2).all()
    later = interfering(times + 0.46, GRID, RECEIVER, other, 1500.0) > 0
    arrival = 0.04 * 1500.0 / 2
    assert GRID.ranges[np.flatnonzero(later[0])[0]] == pytest.approx(arrival, abs=2 * GRID.cell)


def test_a_round_sector_does_not_look_twice_into_one_direction() -> None:
    grid = RECORD.model_copy(update={'sector_deg': 360.0}).grid()
    assert grid.angles[-1] - grid.angles[0] == pytest.approx(2 * math.pi * (1 - 1 / RECORD.beams))
