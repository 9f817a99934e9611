"""What a scenario says of the sea, and what it gets."""

import collections
import math
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.core.errors import ScenarioError
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.water import Water
from trawl_ros.scenario.run import Trial, periods_per_truth
from trawl_ros.scenario.scenario import Scenario, load_scenario
from trawl_ros.scenario.sea import SeaRecord, build_sea

TRIAL = """\
description: what is around the ship
gear: kaifuha
seed: 7
heading_deg: 90
start: {warp_length_m: 500, speed_m_s: 2.1}
steps: [{name: hold, minutes: 2}]
truth_rate_hz: 2.0
"""
SEA = """\
sea:
  heave: {height_m: 2.5, period_s: 8, begin_minutes: 1, growth_minutes: 2}
  seabed:
    direction_deg: 90
    profile:
      - {distance_m: 0, depth_m: 300}
      - {distance_m: 2000, depth_m: 310}
  schools:
    - {east_m: 0, north_m: 900, depth_m: 90, size_east_m: 80, size_north_m: 60, size_up_m: 20,
       density_per_m3: 0.5}
"""


def load(folder: Path, text: str) -> Scenario:
    path = folder / 'trial.yaml'
    path.write_text(text)
    return load_scenario(path)


def test_the_sea_of_a_scenario_is_calm_bottomless_and_empty(tmp_path: Path) -> None:
    sea = build_sea(load(tmp_path, TRIAL).record.sea, Water(), 0)
    assert sea.heave.shortest_period == math.inf
    assert sea.seabed_under(np.zeros(3), np.zeros(3)).under_ship == math.inf
    assert sea.schools == ()


def test_the_file_says_heave_seabed_and_schools(tmp_path: Path) -> None:
    sea = build_sea(load(tmp_path, TRIAL + SEA).record.sea, Water(), 7)
    assert (sea.heave.begin, sea.heave.growth) == (60.0, 120.0)
    assert sea.heave.shortest_period == pytest.approx(4.0, rel=0.04)
    late = [sea.heave.at(t)[0] for t in np.arange(200.0, 3000.0, 0.5)]
    assert 4 * np.std(late) == pytest.approx(2.5, rel=0.1)
    seabed = sea.seabed_under(np.array([0.0, 1000.0, 0.0]), np.array([500.0, 0.0, -80.0]))
    assert (seabed.under_ship, seabed.under_headrope) == pytest.approx((305.0, 300.0))
    (school,) = sea.schools_at(0.0)
    assert school.position.tolist() == [0.0, 900.0, -90.0]
    assert school.size.tolist() == [80.0, 60.0, 20.0]
    assert school.density == 0.5


def test_a_school_drifts_with_the_current_at_its_depth_and_swims_besides() -> None:
    water = Water(depths=np.array([0.0, 100.0]), currents=np.array([[0.5, 0.0], [0.1, 0.2]]))
    place = {'east_m': 0.0, 'north_m': 0.0, 'depth_m': 100.0}
    size = {'size_east_m': 9.0, 'size_north_m': 9.0, 'size_up_m': 9.0, 'density_per_m3': 1.0}
    swimming = {'swims_east_m_s': 0.3, 'swims_north_m_s': -0.2}
    record = SeaRecord.model_validate({'schools': (place | size, place | size | swimming)})
    drifting, swims = build_sea(record, water, 0).schools_at(10.0)
    np.testing.assert_allclose(drifting.position, [1.0, 2.0, -100.0])
    np.testing.assert_allclose(swims.position, [4.0, 0.0, -100.0])


def test_waves_follow_the_seed_of_the_trial(tmp_path: Path) -> None:
    record = load(tmp_path, TRIAL + SEA).record.sea
    once, again, other = (build_sea(record, Water(), seed).heave.at(300.0) for seed in (7, 7, 8))
    assert once == again != other


@pytest.mark.parametrize(
    ('old', 'new', 'said'),
    [
        ('height_m: 2.5', 'height_m: 25', r'sea\.heave\.height_m: found 25, expected'),
        ('period_s: 8', 'period_s: 2', r'sea\.heave\.period_s: found 2, expected'),
        ('height_m: 2.5', 'kind: breaking, height_m: 2', r"found 'breaking', expected"),
        ('distance_m: 2000', 'distance_m: 0', 'profile: '),
        ('depth_m: 90', 'depth_m: 9', r'depth_m: found 9, .*size_up_m'),
        (
            'density_per_m3: 0.5',
            'density_per_m3: -1',
            r'sea\.schools\[0\]\.density_per_m3: found -1, .*per cubic metre',
        ),
    ],
)
def test_a_sea_that_cannot_be_is_refused(tmp_path: Path, old: str, new: str, said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        load(tmp_path, TRIAL + SEA.replace(old, new))


@pytest.mark.parametrize(('wave', 'periods'), [(math.inf, 2), (12.0, 2), (6.0, 5), (2.5, 10)])
def test_the_shorter_the_waves_the_shorter_the_steps(wave: float, periods: int) -> None:
    assert periods_per_truth(2.0, wave) == periods
    assert 0.5 / periods <= wave / 40


def test_a_trial_is_towed_through_its_sea(tmp_path: Path, model: GearModel) -> None:
    rough = SEA.replace('begin_minutes: 1, growth_minutes: 2', 'growth_minutes: 0.25')
    trial = Trial(load(tmp_path, TRIAL + rough), model=model)
    truths = [truth for _ in range(60) if (truth := trial.step()) is not None]
    heights = np.array([truth.vessel.position[2] for truth in truths])
    expected = [trial.simulation.sea.heave.at(truth.stamp / 1e9)[0] for truth in truths]
    np.testing.assert_allclose(heights, expected, atol=1e-4)
    assert np.ptp(heights) > 0.5
    # She steams north, where it gets deeper by 5 m per km.
    last = truths[-1]
    assert last.seabed.under_ship == pytest.approx(300.0 + 0.005 * last.vessel.position[1])
    assert len(last.schools) == 1


def test_where_the_gear_touches_the_seabed_the_file_and_the_step_are_named(
    tmp_path: Path, model: GearModel
) -> None:
    shallow = SEA.replace('depth_m: 300', 'depth_m: 150').replace('310', '150')
    with pytest.raises(ScenarioError, match=r'trial\.yaml: start: .*seabed'):
        Trial(load(tmp_path, TRIAL + shallow), model=model)
    bank = (
        'sea: {seabed: {direction_deg: 90, profile: [{distance_m: -556, depth_m: 232}, '
        '{distance_m: -476, depth_m: 148}, {distance_m: -396, depth_m: 138}]}}\n'
    )
    trial = Trial(load(tmp_path, TRIAL + bank), model=model)
    # Both sides are as deep but for rounding: which of them is named first is chance.
    touches = r"trial\.yaml: step 'hold', after \d+\.\d s: the (port|starboard) .* touches"
    with pytest.raises(ScenarioError, match=touches):
        collections.deque(iter(trial.step, None), maxlen=0)
