"""The openings are read off the image and off nothing else, and not where they cannot be."""

import inspect
import math

import numpy as np
import pytest

from trawl_ros.instruments.sonar.detection import clear_echoes, first_echoes
from trawl_ros.instruments.sonar.image import Grid
from trawl_ros.instruments.sonar.reading import (
    LineSearch,
    Openings,
    ReadingOptions,
    follow,
    read_openings,
)

GRID = Grid(80, 450, math.radians(-100.0), math.radians(200.0 / 79), 1.0, 90.0, 40.0)
SIDE = 30.0
FOOTROPE = 64.0


def noise(seed: int = 0) -> np.ndarray:
    """Noise whose level rises with range, as time-varied gain makes it."""
    mean = -70.0 + 40 * np.log10(GRID.ranges / 30.0)
    drawn = np.random.default_rng(seed).standard_exponential((GRID.beams, GRID.cells))
    level = mean + 10 * np.log10(drawn)
    return np.clip((level + 60.0) / GRID.span * 255, 0, 255)


def painted(image: np.ndarray, places: np.ndarray, brightness: float = 150.0) -> np.ndarray:
    """An image with echoes at places (k, 2), down and to port, two beams and three cells each."""
    image = image.copy()
    away, angle = np.hypot(*places.T), np.arctan2(places[:, 1], places[:, 0])
    beam = (angle - GRID.angle_min) / GRID.angle_increment
    column = np.round(away / GRID.cell - 0.5).astype(int)
    for row in (np.floor(beam).astype(int), np.ceil(beam).astype(int)):
        for shift in (-1, 0, 1):
            at = np.clip(row, 0, GRID.beams - 1), np.clip(column + shift, 0, GRID.cells - 1)
            image[at] = np.maximum(image[at], brightness)
    return image


def net() -> np.ndarray:
    """Netting at both sides, ropes further down, and the footrope."""
    turn = np.radians(np.arange(-70.0, 71.0, 4.0))
    side = np.column_stack([17.0 + 9.0 * np.sin(turn), SIDE - 9.0 + 9.0 * np.cos(turn)])
    ropes = np.array([[38.0, 27.0], [47.0, 25.0], [55.0, 20.0], [61.0, 11.0]])
    port = np.concatenate([side, ropes])
    return np.concatenate([port, port * [1.0, -1.0], [[FOOTROPE, 0.0]]])


def image(seed: int = 0, *, scale: float = 1.0) -> np.ndarray:
    return painted(noise(seed), scale * net()).astype(np.uint8)


def test_nothing_goes_in_but_the_image_and_what_it_means() -> None:
    given = inspect.signature(read_openings).parameters
    assert list(given) == ['image', 'grid', 'options']
    assert given['options'].default == ReadingOptions()


def test_a_net_is_read_as_it_was_painted() -> None:
    found = [read_openings(image(seed), GRID) for seed in range(20)]
    np.testing.assert_allclose([o.height for o in found], FOOTROPE, atol=0.25)
    np.testing.assert_allclose([o.width for o in found], 2 * SIDE, atol=1.0)


@pytest.mark.parametrize('scale', [0.7, 0.85, 1.15])
def test_change_the_image_alone_and_the_reading_changes(scale: float) -> None:
    found = read_openings(image(scale=scale), GRID)
    assert found.height == pytest.approx(scale * FOOTROPE, abs=0.3)
    # At the sides the painting is as coarse as a beam is wide, 1.5 m.
    assert found.width == pytest.approx(scale * 2 * SIDE, abs=1.5)


def test_the_same_image_of_another_range_is_read_as_larger() -> None:
    doubled = Grid(80, 450, GRID.angle_min, GRID.angle_increment, 2.0, 180.0, 40.0)
    once, twice = read_openings(image(), GRID), read_openings(image(), doubled)
    assert twice.height == pytest.approx(2 * once.height)
    assert twice.width == pytest.approx(2 * once.width, rel=0.02)


@pytest.mark.parametrize('brightness', [0.0, 60.0, 255.0])
def test_an_image_without_a_net_is_not_read(brightness: float) -> None:
    for blank in (np.full((80, 450), brightness), noise() + brightness):
        shown = np.clip(blank, 0, 255).astype(np.uint8)
        found = read_openings(shown, GRID)
        assert math.isnan(found.height)
        assert math.isnan(found.width)


def test_one_side_alone_gives_a_height_and_no_width() -> None:
    half = net()[net()[:, 1] > -1.0]
    found = read_openings(painted(noise(), half).astype(np.uint8), GRID)
    assert found.height == pytest.approx(FOOTROPE, abs=0.3)
    assert math.isnan(found.width)


def ellipse(down: float, port: float, height: float, width: float, count: int) -> np.ndarray:
    draw = np.random.default_rng(5)
    away, turn = np.sqrt(draw.random(count)), draw.random(count) * 2 * math.pi
    return np.column_stack(
        [down + 0.5 * height * away * np.cos(turn), port + 0.5 * width * away * np.sin(turn)]
    )


@pytest.mark.parametrize('count', [5, 60, 1000])
def test_fish_between_the_ropes_do_not_matter(count: int) -> None:
    fish = ellipse(36.0, 0.0, 25.0, 24.0, count)
    found = read_openings(painted(image(), fish, 190.0).astype(np.uint8), GRID)
    assert found.height == pytest.approx(FOOTROPE, abs=0.3)
    assert found.width == pytest.approx(2 * SIDE, abs=1.0)


def test_fish_around_the_footrope_hide_it_and_not_the_sides() -> None:
    fish = ellipse(62.0, 0.0, 35.0, 60.0, 200)
    found = read_openings(painted(image(), fish, 150.0).astype(np.uint8), GRID)
    assert math.isnan(found.height)
    assert found.width == pytest.approx(2 * SIDE, abs=1.0)


def test_fish_all_around_hide_the_net() -> None:
    fish = ellipse(20.0, 0.0, 150.0, 180.0, 3000)
    found = read_openings(painted(image(), fish, 150.0).astype(np.uint8), GRID)
    assert math.isnan(found.height)
    assert math.isnan(found.width)


@pytest.mark.parametrize('slope', [0.0, 0.1, -0.15])
@pytest.mark.parametrize('depth', [70.0, 80.0])
def test_a_seabed_in_view_is_not_the_footrope(depth: float, slope: float) -> None:
    port = np.arange(-85.0, 85.0, 0.4)
    seabed = np.column_stack([depth + slope * port, port])
    seabed = seabed[np.hypot(*seabed.T) < 89.5]
    found = read_openings(painted(image(), seabed, 250.0).astype(np.uint8), GRID)
    assert found.height == pytest.approx(FOOTROPE, abs=0.3)
    assert found.width == pytest.approx(2 * SIDE, abs=1.0)


def test_dead_beams_and_speckle_are_survived() -> None:
    draw = np.random.default_rng(3)
    found: list[Openings] = []
    for seed in range(40):
        shown = image(seed)
        shown[draw.random(GRID.beams) < 0.05] = 0
        found.append(read_openings(shown, GRID))
    heights = np.array([o.height for o in found])
    assert np.mean(np.abs(heights - FOOTROPE) < 0.3) > 0.9
    assert np.nanmax(np.abs(np.array([o.width for o in found]) - 2 * SIDE)) < 1.5


def test_noise_alone_gives_hardly_an_echo() -> None:
    cells = [len(clear_echoes(noise(seed).astype(np.uint8), GRID)[0]) for seed in range(30)]
    assert np.mean(cells) < 1.0


def test_echoes_are_found_once_each_and_the_nearest_of_each_beam_first() -> None:
    shown = np.zeros((GRID.beams, GRID.cells), dtype=np.uint8)
    shown[10, 100:104] = [150, 200, 180, 150]
    shown[10, 300:303] = 220
    shown[50, 222:224] = 240
    rows, columns = clear_echoes(shown, GRID)
    assert rows.tolist() == [10, 10, 50]
    assert columns == pytest.approx([101.5, 301, 222.5], abs=0.6)
    ranges, intensities = first_echoes(shown, GRID)
    assert np.flatnonzero(np.isfinite(ranges)).tolist() == [10, 50]
    assert ranges[[10, 50]] == pytest.approx(GRID.cell * np.array([102.0, 223.0]), abs=GRID.cell)
    assert intensities[[10, 50]].tolist() == [shown[10, columns[0]], shown[50, columns[2]]]
    assert intensities[20] == 0.0


def test_the_line_through_an_image_goes_on_where_brighter_spots_lie_apart() -> None:
    level = np.zeros((30, 200))
    line = 100 + 2 * np.arange(30)
    level[np.arange(30), line] = 15.0
    level[3, 20] = level[12, 190] = level[25, 40] = 60.0
    level[14:16] = 0.0
    np.testing.assert_allclose(follow(level, LineSearch()), line, atol=4)
