"""The trawl sonar as an instrument: its sweep takes time, and its errors show in the image."""

import math
import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.faults import Fault, FaultPanel
from trawl_ros.instruments.errors.instrument import SeedPlan
from trawl_ros.instruments.parameters import SweepParameters, load_instruments
from trawl_ros.instruments.sonar.reading import read_openings
from trawl_ros.instruments.sonar.records import InterferenceRecord
from trawl_ros.instruments.sonar.sweep import Sweep
from trawl_ros.instruments.trawl_sonar import SonarInstruments, TrawlSonar
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.water import Water
from trawl_ros.records.partial_truth import partial_truth
from trawl_ros.records.samples import (
    RangeSample,
    Sample,
    SonarImageSample,
    SonarPointsSample,
    SonarScanSample,
)
from trawl_ros.records.surroundings import Surroundings
from trawl_ros.records.truth import NetTruth, SchoolTruth, SeabedTruth, Truth
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.simulation import Simulation

SEA = Surroundings(Water().pressure)
DEPTH = 100.0
POSE = np.array([0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)])
"""Frame ``sonar`` of a ship that heads east: x down, y north, z east."""

SWEEP = load_instruments().sonar.sweep
GRID = SWEEP.grid()
PERIOD_NS = round(SECOND / SWEEP.rate_hz)
PING_S = 1.0 / SWEEP.rate_hz / GRID.beams


def ideal(**changes: Any) -> SweepParameters:
    """The default sonar without errors, that knows the speed of sound, with changes."""
    exact = {
        'assumed_sound_speed_m_s': SEA.sound_speed(DEPTH),
        'dead_ping_share': 0.0,
        'gain': type(SWEEP.gain)(),
        'angle': type(SWEEP.angle)(),
    }
    return SWEEP.model_copy(update={**exact, **changes})


def rope(away: float, row: int = 40, diameter: float = 0.03) -> np.ndarray:
    """A section of one rope at a range (m) in the middle of a beam."""
    angle = float(GRID.angles[row])
    return np.array([[away * math.cos(angle), away * math.sin(angle), diameter]])


def truth(
    stamp: int,
    section: np.ndarray,
    position: Sequence[float] = (0.0, 0.0, -DEPTH),
    schools: tuple[SchoolTruth, ...] = (),
    seabed: float = math.inf,
) -> Truth:
    """An instant with ropes in the sonar's plane; of the rest little is known."""
    nothing = np.zeros((0, 3))
    net = NetTruth(nothing, math.nan, math.nan, -position[2], np.array(position), POSE, section)
    return partial_truth(stamp, net=net, schools=schools, seabed=SeabedTruth(math.inf, seabed))


def still(section: np.ndarray, sweeps: int, **sea: Any) -> list[Truth]:
    """Truth twice a second of ropes that do not move."""
    return [
        truth(k * SECOND // 2, section, **sea) for k in range(2 * sweeps * PERIOD_NS // SECOND + 1)
    ]


def sonar(record: SweepParameters, seed: int = 0) -> TrawlSonar:
    return TrawlSonar(record, SEA, SeedPlan(seed))


def swept(instrument: TrawlSonar, truths: Sequence[Truth]) -> list[Sweep]:
    return [sweep for now in truths for sweep in instrument.observe(now, now.stamp)]


def brightest(row: np.ndarray) -> float:
    """Range (m) of the brightest cell beyond the sonar's own pulse and before far noise."""
    far = (GRID.ranges > 5.0) & (GRID.ranges < 90.0)
    return float(GRID.ranges[far][np.argmax(row[far])])


def test_a_sweep_is_stamped_with_its_first_ping_and_comes_when_it_is_complete() -> None:
    instrument = sonar(ideal())
    found = []
    for now in still(rope(40.0), 3):
        found += [(now.stamp, sweep.stamp) for sweep in instrument.observe(now, now.stamp)]
    assert found == [((k + 1) * PERIOD_NS, k * PERIOD_NS) for k in range(3)]


def test_each_beam_meets_the_gear_at_its_own_time() -> None:
    """Ropes all around that move off by 1 m/s while the sweep goes on lie on a spiral."""

    def ring(seconds: float) -> np.ndarray:
        return np.concatenate([rope(30.0 + seconds, row) for row in range(GRID.beams)])

    moving = [truth(k * SECOND // 10, ring(k / 10)) for k in range(10 * PERIOD_NS // SECOND + 1)]
    (skewed,) = swept(sonar(ideal()), moving)
    rows = np.arange(GRID.beams)
    ranges = np.array([brightest(row) for row in skewed.image])
    np.testing.assert_allclose(ranges, 30.0 + rows * PING_S, atol=2 * GRID.cell)
    slope = np.polyfit(rows * PING_S, ranges, 1)[0]
    assert slope == pytest.approx(1.0, abs=0.02)


def test_truth_that_comes_rarely_is_met_by_all_pings_since() -> None:
    slow = [truth(k * 4 * SECOND, rope(40.0)) for k in range(PERIOD_NS // (4 * SECOND) + 1)]
    (sweep,) = swept(sonar(ideal()), slow)
    assert len(sweep.pings) == GRID.beams
    assert sweep.image[:, GRID.ranges > 80.0].any(axis=1).all()


def test_the_echoes_lie_in_map_where_the_rope_was_when_it_was_hit() -> None:
    section = np.concatenate([rope(40.0, 10), rope(60.0, 60)])
    way = np.array([2.0, 0.5, -0.1])
    start = np.array([500.0, -30.0, -DEPTH])
    moving = [
        truth(k * SECOND // 10, section, start + way * k / 10)
        for k in range(10 * PERIOD_NS // SECOND + 1)
    ]
    (sweep,) = swept(sonar(ideal()), moving)
    points = sweep.points()
    for place, row in zip(section, (10, 60), strict=True):
        sonar_then = start + way * (row * PING_S)
        # Frame sonar of a ship heading east: x is down, y is north.
        rope_then = sonar_then + [0.0, place[1], -place[0]]
        away = np.linalg.norm(points[:, :3] - rope_then, axis=1)
        assert away.min() < 0.5
        assert points[np.argmin(away), 3] > 50


def test_the_reading_scales_with_the_speed_of_sound_that_was_set() -> None:
    exact, fast = (
        swept(sonar(ideal(**more)), still(rope(40.0), 1))[0]
        for more in ({}, {'assumed_sound_speed_m_s': 1.05 * SEA.sound_speed(DEPTH)})
    )
    assert brightest(exact.image[40]) == pytest.approx(40.0, abs=0.3)
    assert brightest(fast.image[40]) == pytest.approx(42.0, abs=0.3)


def test_a_gain_too_high_brightens_all_by_as_much() -> None:
    plain, loud = (
        swept(sonar(ideal(gain=SWEEP.gain.model_copy(update={'offset_db': db, 'noise_db': 0.0}))),
              still(rope(40.0), 1))[0].image.astype(int)
        for db in (0.0, 6.0)
    )  # fmt: skip
    middling = (plain > 20) & (plain < 180) & (GRID.ranges > 5.0)
    counts = 6.0 * 255 / GRID.span
    assert np.abs(loud - plain - counts)[middling].max() <= 1


def test_a_head_that_is_askew_shows_ropes_at_other_angles() -> None:
    askew = SWEEP.angle.model_copy(update={'offset_deg': 10.0, 'noise_deg': 0.0})
    plain, turned = (
        swept(sonar(ideal(**more)), still(rope(40.0, 40), 1))[0].image
        for more in ({}, {'angle': askew})
    )
    column = np.argmin(np.abs(GRID.ranges - 40.0))
    assert np.argmax(plain[:, column]) == 40
    # The beams look more to port than they say, so what they meet seems to be to starboard.
    shift = math.radians(10.0) / GRID.angle_increment
    assert np.argmax(turned[:, column]) == pytest.approx(40 - shift, abs=1)


def test_as_many_pings_are_dead_as_was_said() -> None:
    sweeps = swept(sonar(ideal(dead_ping_share=0.2)), still(rope(40.0), 60))
    dead = np.array([~sweep.image.any(axis=1) for sweep in sweeps])
    count, share = dead.size, dead.mean()
    assert share == pytest.approx(0.2, abs=4 * math.sqrt(0.2 * 0.8 / count))
    (none,) = swept(sonar(ideal()), still(rope(40.0), 1))
    assert none.image.any(axis=1).all()


def test_another_sonar_is_seen_only_where_there_is_one() -> None:
    other = InterferenceRecord(period_s=0.531, pulse_ms=0.5, level_db=162.0)
    (with_other,), (without,) = (
        swept(sonar(ideal(interference=heard)), still(rope(40.0), 1)) for heard in (other, None)
    )
    speed = SEA.sound_speed(DEPTH)
    times = PING_S * np.arange(GRID.beams)[:, None] + 2 * GRID.ranges / speed
    on, far = times % 0.531 < 0.0005, GRID.ranges > 5.0
    hit, missed = on & far, ~on & far
    assert hit.sum() > 30
    assert (with_other.image[hit] > 200).all()
    np.testing.assert_array_equal(with_other.image[missed], without.image[missed])


def test_a_screen_that_hangs_shows_the_image_before() -> None:
    instrument = sonar(ideal())
    truths = still(rope(40.0), 4)
    sweep_long = len(still(rope(40.0), 1))
    first = swept(instrument, truths[:sweep_long])
    instrument.put(Fault('frozen'))
    frozen = swept(instrument, truths[sweep_long : 3 * sweep_long - 2])
    instrument.clear()
    after = swept(instrument, truths[3 * sweep_long - 2 :])
    for sweep in frozen:
        np.testing.assert_array_equal(sweep.image, first[0].image)
    assert [sweep.stamp for sweep in frozen] == [PERIOD_NS, 2 * PERIOD_NS]
    assert (after[0].image != first[0].image).any()
    # All was drawn on, so the end of the fault brings what would have been seen without it.
    undisturbed = swept(sonar(ideal()), truths)
    np.testing.assert_array_equal(after[0].image, undisturbed[3].image)


def test_a_screen_hangs_as_often_and_as_long_as_was_said() -> None:
    record = ideal(freezes_per_hour=60.0, freeze_s=60.0, beams=8, cells=50)
    images = [sweep.image for sweep in swept(sonar(record), still(rope(40.0), 720))]
    repeated = np.mean([np.array_equal(a, b) for a, b in pairwise(images)])
    # A minute of each two, less the first image of each spell that is still new to the eye.
    assert repeated == pytest.approx(0.5, abs=0.12)
    never = [sweep.image for sweep in swept(sonar(ideal(beams=8, cells=50)), still(rope(40.0), 40))]
    assert not any(np.array_equal(a, b) for a, b in pairwise(never))


@pytest.mark.parametrize('quantity', ['gain', 'angle'])
def test_a_lost_gain_or_angle_leaves_a_black_image_and_no_reading(quantity: str) -> None:
    instruments = SonarInstruments(load_instruments().sonar, SeedPlan(1), surroundings=SEA)
    FaultPanel(instruments.instruments).switch(f'sonar/image/{quantity}', 'lost')
    samples = [s for now in still(rope(40.0), 1) for s in instruments.observe(now)]
    (image,) = [s for s in samples if isinstance(s, SonarImageSample)]
    (scan,) = [s for s in samples if isinstance(s, SonarScanSample)]
    (points,) = [s for s in samples if isinstance(s, SonarPointsSample)]
    openings = [s for s in samples if isinstance(s, RangeSample) and s.what != 'bottom']
    assert not image.image.any()
    assert np.isinf(scan.ranges).all()
    assert points.points.shape == (0, 4)
    assert [s.what for s in openings] == ['opening_height', 'opening_width']
    assert all(math.isnan(s.distance) for s in openings)


def test_a_silent_sonar_sends_no_image_and_nothing_read_off_it() -> None:
    instruments = SonarInstruments(load_instruments().sonar, SeedPlan(1), surroundings=SEA)
    FaultPanel(instruments.instruments).switch('sonar/image', 'silent')
    samples = [s for now in still(rope(40.0), 2) for s in instruments.observe(now)]
    assert {type(s).__name__ for s in samples} == {'PressureSample', 'RangeSample'}
    assert {s.what for s in samples if isinstance(s, RangeSample)} == {'bottom'}


def test_one_seed_one_image_and_a_jump_back_begins_anew() -> None:
    truths = still(rope(40.0), 3)
    instrument = sonar(SWEEP, seed=7)
    first, again = swept(instrument, truths), swept(instrument, truths)
    other = swept(sonar(SWEEP, seed=8), truths)
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.image, b.image)
    assert (first[0].image != other[0].image).any()


def test_a_school_around_the_sonar_shows_as_echoes_in_its_cells() -> None:
    school = SchoolTruth(np.array([0.0, 10.0, -DEPTH - 40.0]), np.array([50.0, 20.0, 10.0]), 0.5)
    (empty,), (full,) = (
        swept(sonar(ideal()), still(rope(80.0, 2), 1, schools=schools))
        for schools in ((), (school,))
    )
    angles, ranges = GRID.angles[:, None], GRID.ranges
    down, north = ranges * np.cos(angles), ranges * np.sin(angles)
    within = ((down - 40.0) / 5.0) ** 2 + ((north - 10.0) / 10.0) ** 2 < 0.9
    far = ((down - 40.0) / 9.0) ** 2 + ((north - 10.0) / 14.0) ** 2 > 1.0
    assert full.image[within].mean() > empty.image[within].mean() + 20
    np.testing.assert_array_equal(full.image[far & (ranges < 60.0)],
                                  empty.image[far & (ranges < 60.0)])  # fmt: skip


def readings(samples: Sequence[Sample], what: str) -> list[float]:
    return [s.distance for s in samples if isinstance(s, RangeSample) and s.what == what]


def test_a_net_in_tow_is_read_off_the_image_and_costs_little(default_model: GearModel) -> None:
    tow = Simulation(default_model, Command(300.0, 300.0, 2.1)).truth()
    truths = [replace(tow, stamp=k * SECOND // 10) for k in range(401)]
    instruments = SonarInstruments(load_instruments().sonar, SeedPlan(2), surroundings=SEA)
    began = time.process_time()
    samples = [s for now in truths for s in instruments.observe(now)]
    spent = time.process_time() - began
    heights = [
        s.distance for s in samples if isinstance(s, RangeSample) and s.what == 'opening_height'
    ]
    widths = [
        s.distance for s in samples if isinstance(s, RangeSample) and s.what == 'opening_width'
    ]
    stretch = 1500.0 / SEA.sound_speed(tow.net.headrope_depth)
    np.testing.assert_allclose(heights, stretch * tow.net.section_height, atol=0.4)
    np.testing.assert_allclose(widths, stretch * tow.net.section_width, atol=1.5)
    # Two per cent of a core: the whole chain has one for itself.
    assert spent < 0.02 * 40.0
    image = next(s for s in samples if isinstance(s, SonarImageSample))
    assert read_openings(image.image, GRID).height == pytest.approx(heights[0], abs=0.051)
