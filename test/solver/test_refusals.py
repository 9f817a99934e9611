"""Where there is no usable steady state, the solver says so, and why, within bounded time."""

import time

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState, sentence_of
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.solver.equilibrium import SteadyState, find_equilibrium, steady_state
from trawl_ros.solver.operating_point import OperatingPoint, remedy_command
from trawl_ros.solver.stability import stability


def test_an_unstable_root_is_refused(model: GearModel, steady: SteadyState) -> None:
    # With the other sign of b3 the board is pushed on by flow along its span.
    values = model.coefficients.copy()
    values[COEFFICIENTS.index('b3')] *= -2.0
    driven = model.with_coefficients(values)
    point = OperatingPoint(500.0, 500.0, 2.1)
    root = find_equilibrium(driven, point, steady.equilibrium)
    assert not stability(driven, root.state, root.tow).stable
    with pytest.raises(NoSteadyState, match=r'warp 500 m at 2\.1 m/s') as refused:
        steady_state(driven, 500.0, 2.1, start=steady.equilibrium)
    assert refused.value.reason == 'unstable'


@pytest.mark.parametrize(('warp', 'speed'), [(200.0, 4.0), (200.0, 3.5)])
def test_gear_that_breaks_the_surface_is_refused(
    default_model: GearModel, warp: float, speed: float
) -> None:
    before = time.process_time()
    with pytest.raises(NoSteadyState, match=rf'warp {warp:g} m at {speed:g} m/s: ') as surfaced:
        steady_state(default_model, warp, speed)
    assert time.process_time() - before < 20.0
    # No command helps against it.
    assert (surfaced.value.reason, surfaced.value.remedy) == ('surfaced', '')
    assert sentence_of(surfaced.value) == str(surfaced.value)


@pytest.mark.parametrize('speed', [0.5, 0.6])
def test_gear_that_is_towed_too_slowly_is_refused_in_bounded_time(
    model: GearModel, speed: float
) -> None:
    before = time.process_time()
    with pytest.raises(NoSteadyState, match=rf'warp 500 m at {speed:g} m/s'):
        steady_state(model, 500.0, speed)
    assert time.process_time() - before < 10.0


def test_a_tow_slowed_down_is_refused_from_where_it_was(
    model: GearModel, steady: SteadyState
) -> None:
    slow = find_equilibrium(model, OperatingPoint(500.0, 500.0, 1.8), steady.equilibrium)
    with pytest.raises(NoSteadyState, match=r'warp 500 m at 0\.5 m/s.* 1\.8 m/s.* [01]\.\d+ m/s'):
        find_equilibrium(model, OperatingPoint(500.0, 500.0, 0.5), slow)


def test_a_collapsed_board_is_refused(model: GearModel, steady: SteadyState) -> None:
    turned = model.with_board(installation=(np.radians(-20.0), 0.0, 0.0))
    for start in (None, steady.equilibrium):
        with pytest.raises(NoSteadyState, match=r' -\d+\.\d') as caught:
            steady_state(turned, 500.0, 2.1, start=start)
        assert caught.value.reason == 'collapsed'


def test_a_board_with_far_other_forces_is_refused_with_its_moments() -> None:
    # Drawn from the prior: its forces pull the gear far from the first guess.
    drawn = np.array(
        [2.133, 0.119, 4.28, 0.574, 0.606, -0.028, -0.412, 0.03, -0.216, 0.016, 0.916, 0.507]
    )
    netting = (gear := load_gear('kaifuha')).netting.model_copy(update={'around': 24})
    board = build_model(gear.model_copy(update={'netting': netting})).with_coefficients(drawn)
    with pytest.raises(NoSteadyState, match=r'(\d kN m .*){3}') as caught:
        steady_state(board, 800.0, 2.0)
    assert caught.value.reason == 'no balance'


@pytest.mark.parametrize(
    ('behind_m', 'words', 'reason'),
    [
        # The boards turn across the flow, where eq. 14 does not hold.
        (0.3, '40°', 'outside law'),
        # Behind the centre of pressure the pull turns the leading edge outward.
        (0.5, r'(\d kN m .*){3}', 'no balance'),
    ],
)
def test_boards_whose_warp_pulls_far_aft_are_refused(
    model: GearModel, behind_m: float, words: str, reason: str
) -> None:
    points = model.board.points - [[behind_m, 0.0, 0.0], [0.0] * 3, [0.0] * 3]
    with pytest.raises(NoSteadyState, match=words) as caught:
        steady_state(model.with_board(points=points), 500.0, 2.1)
    assert caught.value.reason == reason


def test_a_shape_that_still_moves_at_another_speed_gives_no_state_of_that_speed(
    model: GearModel, steady: SteadyState
) -> None:
    point = OperatingPoint(500.0, 500.0, 2.2)
    found = find_equilibrium(model, point, near=steady.equilibrium.state)
    np.testing.assert_allclose(found.state.node_velocities[:, 0], 2.2)
    expected = find_equilibrium(model, point).observables.array()
    np.testing.assert_allclose(found.observables.array(), expected, rtol=1e-6, atol=1e-7)


def test_heavy_boards_are_told_with_the_speed_at_which_their_branch_folds_back(
    gear: GearRecord,
) -> None:
    board = gear.board.model_copy(update={'mass_kg': 3.0 * gear.board.mass_kg})
    netting = gear.netting.model_copy(update={'around': 12})
    heavy = build_model(gear.model_copy(update={'board': board, 'netting': netting}))
    before = time.process_time()
    folds = r' 2\.\d+ m/s.* 3\.\d+ m/s'
    with pytest.raises(NoSteadyState, match=folds) as lost:
        steady_state(heavy, 500.0, 2.1)
    assert lost.value.reason == 'fold'
    assert time.process_time() - before < 10.0


def test_of_what_is_unstable_the_growing_motion_is_named(default_model: GearModel) -> None:
    turned = default_model.with_board(installation=(np.radians(15.0), 0.0, 0.0))
    start = find_equilibrium(default_model, OperatingPoint(500.0, 500.0, 2.1))
    with pytest.raises(NoSteadyState, match='one board against') as told:
        steady_state(turned, 500.0, 2.1, start=start)
    assert told.value.reason == 'unstable'
    assert told.value.remedy.startswith('`trawl gear state kaifuha --warp 500 --speed 2.1`')
    assert getattr(told.value, '__notes__', []) == [told.value.remedy]
    assert sentence_of(told.value) == f'{told.value}\n{told.value.remedy}'


def test_of_a_gear_with_a_file_of_its_own_the_command_asks_for_the_file(gear: GearRecord) -> None:
    mine = gear.model_copy(update={'name': '../mine'})
    told = remedy_command(mine, OperatingPoint(410.0, 390.0, 1.5))
    assert told.startswith('`trawl gear state GEAR --warp 400 --speed 1.5`')


def test_a_gear_whose_boards_lie_on_their_backs_is_refused_though_it_is_stable(
    model: GearModel,
) -> None:
    fallen = model.with_board(installation=(np.radians(15.0), 0.0, 0.0))
    with pytest.raises(NoSteadyState) as refusal:
        steady_state(fallen, 500.0, 2.1)
    assert refusal.value.reason in {'collapsed', 'lift lost'}
