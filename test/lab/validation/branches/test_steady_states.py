"""The map of steady states: what a walk finds, what a second branch would look like to it."""

import json
from dataclasses import replace

import numpy as np
import pytest

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.lab.validation.branches.continuation import Place, Search, continue_branches, judged
from trawl_ros.lab.validation.branches.facts import branch_checks, smoothness_checks
from trawl_ros.lab.validation.branches.lattices import Lattice, speed_lattice
from trawl_ros.lab.validation.branches.steady_states import (
    CASE,
    collapsed_shapes,
    tally,
    turned_boards,
)
from trawl_ros.lab.validation.run import check_record
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium
from trawl_ros.solver.operating_point import OperatingPoint


@pytest.fixture(scope='module')
def good(model: GearModel) -> Equilibrium:
    return find_equilibrium(model, OperatingPoint(500.0, 500.0, 2.1))


@pytest.fixture(scope='module')
def lattice(model: GearModel) -> Lattice:
    return speed_lattice(model, (300.0, 500.0), (0.5, 2.1))


@pytest.mark.slow
def test_the_small_map_misses_what_the_report_misses_alone() -> None:
    outcome = CASE.run(True)
    missed = {check.key for check in outcome.rows if not check.ok}
    assert missed <= {'bowed_short', 'collapsed_starts'}
    json.dumps([check_record(check) for check in outcome.rows])
    assert len(outcome.drawings) == 3


def test_a_walk_reaches_what_neighbours_lead_to_and_searches_the_rest_cold(
    lattice: Lattice,
) -> None:
    verdicts = {spot: answer.verdict for spot, answer in lattice.answers.items()}
    assert verdicts == {
        (0, 0): 'none found',
        (0, 1): 'usable',
        (1, 0): 'none found',
        (1, 1): 'usable',
    }
    # Cold at the start, then once from the neighbour and, a third of them, cold once more.
    assert lattice.at(1, 1).searches == 2
    assert lattice.at(0, 1).searches == 1


def test_a_place_no_neighbour_leads_to_is_searched_cold(model: GearModel) -> None:
    places = {
        (0, 0): Place(model, OperatingPoint(500.0, 500.0, 2.1)),
        (0, 2): Place(model, OperatingPoint(500.0, 500.0, 2.2)),
    }
    answers = continue_branches(places, (0, 0), also_cold=())
    assert [answer.verdict for answer in answers.values()] == ['usable', 'usable']


def test_two_usable_roots_at_a_place_are_told_apart(model: GearModel, good: Equilibrium) -> None:
    place = Place(model, good.point)
    aside = replace(good, state=good.state.shifted(np.array([0.0, 2.0, 0.0])))
    answer = judged(place, [Search(good, None, 0.1), Search(aside, None, 0.1)])
    assert answer.usable_roots == 2
    assert answer.apart == pytest.approx(2.0)
    lattice = Lattice('speed', (500.0,), (2.1,), {(0, 0): answer})
    failing = {check.key for check in branch_checks('speed', [lattice]) if not check.ok}
    assert failing == {'speed_apart', 'speed_second_branch'}


def test_a_start_that_finds_nothing_where_others_do_is_noticed(
    model: GearModel, good: Equilibrium
) -> None:
    place = Place(model, good.point)
    answer = judged(
        place, [Search(good, None, 0.1), Search(None, NoSteadyState('fallen', 'collapsed'), 0.1)]
    )
    lattice = Lattice('speed', (500.0,), (2.1,), {(0, 0): answer})
    failing = {check.key for check in branch_checks('speed', [lattice]) if not check.ok}
    assert failing == {'speed_depends_on_start'}


def test_a_jump_to_another_branch_is_noticed(lattice: Lattice) -> None:
    assert all(check.ok for check in smoothness_checks(lattice))
    here = lattice.at(1, 1)
    assert here.root is not None
    fallen = replace(here.root.observables, port_attack=np.radians(41.0), door_spread=30.0)
    jumped = replace(here, root=replace(here.root, observables=fallen))
    changed = replace(lattice, answers={**lattice.answers, (1, 1): jumped})
    failing = [check.key for check in smoothness_checks(changed) if not check.ok]
    assert failing == ['jump', 'grows_1']


def test_boards_are_turned_as_named(good: Equilibrium) -> None:
    both = turned_boards((-5.0, 0.0))
    # The port board's leading edge points inward, to starboard, and starboard's mirrors it.
    assert both[0][:, 0] == pytest.approx([np.cos(np.radians(5)), -np.sin(np.radians(5)), 0.0])
    assert both[1][:, 0] == pytest.approx([np.cos(np.radians(5)), np.sin(np.radians(5)), 0.0])
    assert np.linalg.det(both) == pytest.approx([1.0, 1.0])
    assert len(collapsed_shapes(good.state)) == 17


def test_searches_from_collapsed_shapes_are_counted_by_what_they_give(
    model: GearModel, good: Equilibrium
) -> None:
    shapes = collapsed_shapes(good.state)[:2]
    assert tally(model, good.point, shapes, good).good == 2
    # Held against a state elsewhere, the same answers are another state.
    elsewhere = replace(good, state=good.state.shifted(np.array([0.0, 0.0, 1.0])))
    assert tally(model, good.point, shapes, elsewhere).other == 2
