"""The study of robustness: its trials, how it resumes, and what it counts."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import WorkProgress
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.studies.robustness.changed_values import changed, numbers, tow_outcome
from trawl_ros.lab.studies.robustness.random_commands import commanded_hour
from trawl_ros.lab.studies.robustness.report import write_robustness
from trawl_ros.lab.studies.robustness.study import (
    RobustnessPlan,
    RobustnessTrial,
    kept,
    run_robustness,
)
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import fallen_boards
from trawl_ros.model.rotations import about_axis
from trawl_ros.solver.equilibrium import SteadyState, steady_state


def test_numbers_of_a_gear_are_changed_one_at_a_time(gear: GearRecord) -> None:
    keys = list(numbers(gear))
    assert {'warp.diameter_m', 'netting.body.0.mesh_m', 'board.fastening.warp_m.1'} <= set(keys)
    assert not {'netting.around', 'board.inertia.xz_kg_m2'} & set(keys)
    heavier = changed(gear, 'board.mass_kg', 1.2)
    assert heavier.board.mass_kg == pytest.approx(1.2 * gear.board.mass_kg)
    board = heavier.board.model_copy(update={'mass_kg': gear.board.mass_kg})
    assert heavier.model_copy(update={'board': board}) == gear


def test_a_number_no_gear_may_have_is_no_failure(gear: GearRecord) -> None:
    outcome, sentence = tow_outcome(gear, 'netting.wing_edge_hanging', 1.2, 500.0)
    assert outcome == 'impossible'
    assert 'wing_edge_hanging' in sentence


def test_a_part_of_an_hour_of_commands_is_towed(model: GearModel) -> None:
    hour = commanded_hour(model, 3, duration=60.0, recovery=10.0)
    assert (hour.failure, hour.reached_s) == ('', 60.0)
    assert commanded_hour(model, 3, duration=60.0, recovery=10.0) == hour


@pytest.fixture(scope='module')
def steady(model: GearModel) -> SteadyState:
    return steady_state(model, 500.0, 2.1)


@pytest.mark.parametrize(('lean', 'fallen'), [(0.0, False), (-60.0, True), (60.0, True)])
def test_a_board_on_its_face_or_back_has_fallen(
    steady: SteadyState, lean: float, fallen: bool
) -> None:
    state = steady.equilibrium.state
    port, starboard = state.board_rotations
    turned = np.stack([about_axis(0, np.radians(lean)) @ port, starboard])
    assert fallen_boards(replace(state, board_rotations=turned)) == (fallen, False)


def test_it_resumes_with_what_is_not_kept_yet(tmp_path: Path) -> None:
    plan = RobustnessPlan(around=12, hours=0, lengths=(500.0,), shards=60)

    def stopping(progress: WorkProgress) -> None:
        if progress.done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_robustness(plan, tmp_path, stopping)
    first = kept(tmp_path)
    assert len(first) == 2
    # A line that a killed study left without its end is not counted.
    (path,) = tmp_path.glob('trials_*.jsonl')
    path.write_text(path.read_text() + '{"part": ')
    assert kept(tmp_path) == first
    whole = run_robustness(plan, tmp_path, lambda progress: None)
    assert whole[:2] == first
    assert len({trial.name for trial in whole}) == len(whole) > 2
    write_robustness(tmp_path, whole)
    counted = json.loads((tmp_path / 'robustness.json').read_text())['trials']
    assert len(counted) == len(whole)
    path.write_text('[]\n')
    with pytest.raises(TrawlError, match='line 1 is not a trial'):
        kept(tmp_path)


def test_the_report_tells_hours_that_failed_with_their_interval(tmp_path: Path) -> None:
    hours = [
        RobustnessTrial('commands', f'hour {seed}', 12, 'towed', '', 9.0, 60.0 * seed)
        for seed in range(9)
    ]
    failed = RobustnessTrial('commands', 'hour 9', 12, 'failed', 'no step', 9.0)
    rows = {row.what: row for row in write_robustness(tmp_path, [*hours, failed])}
    share = rows['share of hours that ended before their time']
    # Clopper and Pearson: 1 of 10.
    assert (share.low, share.value, share.high) == pytest.approx((0.253, 10.0, 44.50), abs=0.01)
    assert rows['hours in which a board fell'].value == 8
    assert not rows['hours that ended before their time'].ok
    assert (tmp_path / 'robustness.png').is_file()
    assert 'hour 9: no step' in (tmp_path / 'robustness.md').read_text()
