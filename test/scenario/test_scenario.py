"""A scenario file says what a trial does, or what is wrong with it."""

import math
from pathlib import Path

import pytest

from trawl_ros.core.errors import ScenarioError
from trawl_ros.core.resources import share_path
from trawl_ros.scenario.scenario import load_scenario
from trawl_ros.simulation.command import Command

TRIAL = """\
description: two lengths and a turn
gear: kaifuha
seed: 7
heading_deg: 90
start: {warp_length_m: 300, speed_m_s: 2.0}
steps:
  - {name: hold, minutes: 2}
  - {name: veer, minutes: 3.5, warp_length_m: 400, speed_m_s: 2.2}
  - {name: still, minutes: 1}
  - {name: turn, minutes: 1, turn_deg_s: 0.5, port_warp_length_m: 410}
"""


def write(folder: Path, text: str) -> Path:
    path = folder / 'trial.yaml'
    path.write_text(text)
    return path


def complaint(folder: Path, text: str) -> str:
    path = write(folder, text)
    with pytest.raises(ScenarioError) as caught:
        load_scenario(path)
    assert str(caught.value).startswith(f'{path}: ')
    return str(caught.value).removeprefix(f'{path}: ')


def test_commands_follow_the_steps_and_keep_what_is_not_named(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path, TRIAL))
    veered = Command(400.0, 400.0, 2.2)
    assert scenario.start == Command(300.0, 300.0, 2.0)
    assert scenario.commands == (
        (0.0, Command(300.0, 300.0, 2.0)),
        (120.0, veered),
        (330.0, veered),
        (390.0, Command(410.0, 400.0, 2.2, math.radians(0.5))),
    )
    assert scenario.duration_s == 450.0
    assert scenario.heading == pytest.approx(math.pi / 2)


def test_a_step_holds_from_its_begin_to_the_next_and_the_last_for_ever(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path, TRIAL))
    lengths = [scenario.commands_at(t).port_length for t in (0.0, 119.9, 120.0, 389.9, 390.0, 1e6)]
    assert lengths == [300.0, 300.0, 400.0, 400.0, 410.0, 410.0]
    assert scenario.step_at(330.0).name == 'still'
    # As a sum of tenths of a second may give it.
    assert scenario.commands_at(sum([0.1] * 1200)).port_length == 400.0


def test_a_new_state_begins_where_something_new_is_asked_for(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path, TRIAL))
    assert scenario.state_changes_s == (120.0, 390.0)
    assert scenario.draws.seed == 7
    assert scenario.draws.state_changes == (120.0, 390.0)


def test_the_plant_is_the_gear_with_what_the_scenario_changes(tmp_path: Path) -> None:
    scenario = load_scenario(
        write(
            tmp_path,
            TRIAL
            + """\
refine: {warp: 2, net: 2}
coefficients: {a1: 3.5, c6: 0.01}
water:
  density_kg_m3: 1028.0
  current:
    - {depth_m: 0, east_m_s: 0.2, north_m_s: 0}
    - {depth_m: 100, east_m_s: 0.1, north_m_s: 0}
""",
        )
    )
    gear, plant = scenario.gear, scenario.plant
    assert plant.warp.segments == 2 * gear.warp.segments
    assert plant.bridle == gear.bridle
    assert plant.netting.around == 2 * gear.netting.around
    assert (plant.board.coefficients.a1, plant.board.coefficients.c6) == (3.5, 0.01)
    assert plant.board.coefficients.c1 == gear.board.coefficients.c1
    assert plant.water.density_kg_m3 == 1028.0
    assert plant.water.gravity_m_s2 == gear.water.gravity_m_s2
    assert plant.water.current[1].east_m_s == 0.1


def test_without_changes_the_plant_is_the_gear(tmp_path: Path) -> None:
    scenario = load_scenario(write(tmp_path, TRIAL))
    assert scenario.plant == scenario.gear


def test_gear_and_instruments_may_lie_beside_the_scenario(tmp_path: Path) -> None:
    for folder, name in (('gear', 'kaifuha'), ('instruments', 'default')):
        text = share_path('config', folder, f'{name}.yaml').read_text()
        (tmp_path / f'my_{folder}.yaml').write_text(text)
    text = TRIAL.replace('gear: kaifuha', 'gear: my_gear.yaml\ninstruments: my_instruments.yaml')
    assert load_scenario(write(tmp_path, text)).gear == load_scenario(write(tmp_path, TRIAL)).gear


def test_instruments_may_be_overridden_in_place(tmp_path: Path) -> None:
    text = TRIAL + 'instruments: {winch: {rate_hz: 5}}\n'
    assert load_scenario(write(tmp_path, text)).instruments.winch.rate_hz == 5.0


@pytest.mark.parametrize(
    ('old', 'new', 'sentence'),
    [
        ('speed_m_s: 2.0', 'speed_kn: 4', 'start.speed_kn: unknown key'),
        ('warp_length_m: 300, ', '', 'start.warp_length_m: missing'),
        ('warp_length_m: 300', 'warp_length_m: -300', 'start.warp_length_m: found -300'),
        ('warp_length_m: 400', 'warp_length_m: 3001', 'steps[1].warp_length_m: found 3001'),
        ('speed_m_s: 2.2', 'speed_m_s: 5', 'steps[1].speed_m_s: found 5, '),
        ('minutes: 3.5', 'minutes: 0', 'steps[1].minutes: found 0, '),
        ('minutes: 3.5', 'minutes: 2879', 'steps: found 2883 minutes'),
        ('minutes: 3.5, ', '', 'steps[1].minutes: missing'),
        ('minutes: 3.5', 'minutes: 3.5, port_warp_length_m: 5', 'steps[1].warp_length_m: '),
        ('seed: 7', 'seed: -1', 'seed: found -1'),
        ('seed: 7', 'seed: true', 'seed: found true'),
        ('seed: 7', 'truth_rate_hz: 3', 'truth_rate_hz: found 3, '),
        ('seed: 7', 'record: [video]', "record[0]: found 'video', expected 'instruments', 'pic"),
        ('seed: 7', 'coefficients: {a7: 1}', 'coefficients.a7: unknown key, expected a1'),
        ('seed: 7', 'coefficients: {a1: .inf}', 'coefficients.a1: found inf'),
        ('seed: 7', 'refine: {net: 0}', 'refine.net: found 0'),
        ('seed: 7', 'seed: 7\nseed: 8', "line 4, column 1: found key 'seed' again"),
        ('seed: 7', 'instruments: {winch: {rate: 1}}', 'instruments.winch.rate: unknown key'),
        ('seed: 7', 'instruments: nosuch', "instruments: 'nosuch'"),
        ('kaifuha', 'nosuch', "gear: 'nosuch'"),
        ('kaifuha', 'nosuch.yaml', 'nosuch.yaml: no such file'),
        (
            'seed: 7',
            'water: {current: [{depth_m: 9, east_m_s: 0, north_m_s: 0}, '
            '{depth_m: 3, east_m_s: 0, north_m_s: 0}]}',
            'depths must rise',
        ),
    ],
)
def test_a_mistake_is_named_with_its_key(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in TRIAL
    assert sentence in complaint(tmp_path, TRIAL.replace(old, new, 1))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r'nosuch\.yaml: no such file'):
        load_scenario(tmp_path / 'nosuch.yaml')


def test_the_demo_has_five_steady_states_in_twenty_minutes_or_more() -> None:
    demo = load_scenario(share_path('config', 'scenarios', 'demo.yaml'))
    assert len(demo.commands) >= 5
    assert demo.duration_s >= 20 * 60
    assert {command.speed for _, command in demo.commands} != {demo.start.speed}
