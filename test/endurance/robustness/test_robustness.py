"""Changed gears and random commands: a steady state or a reason, and no tow that breaks off."""

from dataclasses import replace

import numpy as np
import pytest

from endurance.robustness.changed_values import changed, numbers, tow_outcome
from endurance.robustness.random_commands import commanded_hour
from endurance.robustness.rows import Outcome, changed_gear, hour_rows, random_hour, value_rows
from endurance.robustness.winch_manoeuvres import (
    MANOEUVRES,
    SPEEDS_M_S,
    STANDING_POINTS_M,
    held_places,
    lets_fall,
    manoeuvre_rows,
)
from endurance.table import FULL
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.model.observables import fallen_boards
from trawl_ros.model.rotations import about_axis
from trawl_ros.solver.equilibrium import SteadyState, steady_state

LENGTHS_M = (500.0, 300.0, 700.0)


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


def test_hours_that_failed_are_told_with_their_interval() -> None:
    hours = [Outcome(f'hour {seed}', 'towed', '', 9.0, 60.0 * seed) for seed in range(9)]
    failed = Outcome('hour 9', 'failed', 'no step', 9.0)
    rows = {row.what: row for row in hour_rows([*hours, failed])}
    share = rows['share of hours that ended before their time']
    # Clopper and Pearson: 1 of 10.
    assert (share.low, share.value, share.high) == pytest.approx((0.253, 10.0, 44.50), abs=0.01)
    assert rows['hours in which a board fell'].value == 8
    assert not rows['hours that ended before their time'].ok
    assert 'hour 9: no step' in rows['hours that ended before their time'].note


@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 400)
def test_changed_gears_have_a_steady_state_or_a_physical_reason(show) -> None:
    gear = MeshResolution(24 if FULL else 12).model('kaifuha')
    changes = [
        (key, factor, length)
        for length in LENGTHS_M
        for key in numbers(gear)
        for factor in (0.8, 1.2)
    ]
    # Compiling at first use is no time of a tow.
    changed_gear(gear, changes[0][0], 1.0, LENGTHS_M[0])
    rows = value_rows([changed_gear(gear, *change) for change in changes[:: 1 if FULL else 10]])
    show('Numbers of the gear file changed by a fifth', rows)
    assert [row.what for row in rows if not row.ok] == []


@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 400)
def test_hours_of_random_commands_are_towed_to_their_end(show) -> None:
    gear = MeshResolution(24 if FULL else 12).model('kaifuha')
    for title, points in (('Hours', None), ('Hours, points sought in motion', STANDING_POINTS_M)):
        seeds = range(30 if FULL else 2)
        rows = hour_rows([random_hour(gear, seed, points) for seed in seeds])
        show(title, rows)
        assert [row.what for row in rows if not row.ok] == []


@pytest.mark.slow
@pytest.mark.timeout(0 if FULL else 400)
def test_boards_stand_when_both_winches_stop_together_up_to_2_5_m_s(show) -> None:
    model = build_model(MeshResolution(24 if FULL else 12).model('kaifuha'))
    speeds = SPEEDS_M_S if FULL else (2.2,)
    show('Winch manoeuvres', [*manoeuvre_rows(model, speeds), held_places(model)])
    standing = model.with_board(points=STANDING_POINTS_M)
    rows = [*manoeuvre_rows(standing, speeds), held_places(standing)]
    show('The same with points that were sought in motion', rows)
    hauling = MANOEUVRES[0]
    assert not any(lets_fall(model, hauling, 300.0, speed) for speed in (1.6, 2.2, 2.5))
