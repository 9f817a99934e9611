"""Boards that are drawn for trials are rigged so that they can be towed in all of its states."""

from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import GearError, TrawlError
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trimming.drawn_board import (
    BoardDraw,
    DrawnBoard,
    draw_board,
    fastened_as,
    with_fastening,
)
from trawl_ros.solver.trimming.over_range import hole_limits

PLACES = [(320.0, 2.1), (320.0, 2.4), (480.0, 2.1), (480.0, 2.4)]
SEED = 1


@pytest.fixture(scope='module')
def gear() -> GearRecord:
    return load_gear('kaifuha').refined(net=0.25)


@pytest.fixture(scope='module')
def drawn(gear: GearRecord) -> DrawnBoard:
    return draw_board(gear, PLACES, np.random.default_rng(SEED))


def test_the_board_can_be_towed_in_all_states_from_its_gear_file_alone(drawn: DrawnBoard) -> None:
    model = build_model(drawn.gear)
    assert set(drawn.steady) == set(PLACES)
    for place in PLACES:
        seen = steady_state(model, *place).observables
        assert seen.door_spread == pytest.approx(drawn.steady[place].observables.door_spread, 1e-3)


def test_it_is_another_board_within_bounds_that_works_near_the_wanted_angles(
    gear: GearRecord, drawn: DrawnBoard
) -> None:
    known = gear.identification
    away = (drawn.coefficients - known.start) / known.std
    assert np.ptp(away) > 1.0
    assert np.all((np.array(known.low) <= drawn.coefficients) & (drawn.coefficients <= known.high))
    assert np.array_equal(drawn.gear.board.coefficients.array(), drawn.coefficients)
    seen = [found.observables for found in drawn.steady.values()]
    attack = np.degrees([one.port_attack for one in seen])
    lean = np.degrees([one.port_inclination for one in seen])
    assert attack.mean() == pytest.approx(20.0, abs=5.0)
    assert lean.mean() == pytest.approx(12.0, abs=8.0)


def test_holes_lie_within_the_room_for_them(gear: GearRecord, drawn: DrawnBoard) -> None:
    board = drawn.model.board
    assert np.all(np.abs(board.points) <= hole_limits(board) + 1e-9)
    assert not np.allclose(board.points, build_model(gear).board.points)


def test_the_same_seed_draws_the_same_board(gear: GearRecord, drawn: DrawnBoard) -> None:
    again = draw_board(gear, PLACES, np.random.default_rng(SEED))
    assert again.gear == drawn.gear
    assert again.draws == drawn.draws == 1 + drawn.rejected.total()


def test_the_gear_as_it_is_known_aboard_has_the_holes_and_not_the_coefficients(
    gear: GearRecord, drawn: DrawnBoard
) -> None:
    known = fastened_as(gear, drawn.gear)
    assert known == with_fastening(gear, drawn.model.board.points)
    assert known.board.coefficients == gear.board.coefficients


def test_what_cannot_be_towed_is_refused_with_the_reasons(gear: GearRecord) -> None:
    few = replace(BoardDraw(), most_draws=2, evaluations=1)
    with pytest.raises(TrawlError, match=r'kaifuha: .*2 boards'):
        draw_board(gear, [(100.0, 4.0)], np.random.default_rng(0), few)


def test_a_gear_without_boards_is_refused() -> None:
    pair = load_gear('pair_368')
    with pytest.raises(GearError, match='boards'):
        draw_board(pair, PLACES, np.random.default_rng(0))
