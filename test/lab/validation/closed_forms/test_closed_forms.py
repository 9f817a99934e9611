"""Closed forms hold in small, and the yardsticks they are held against are right themselves."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from trawl_ros.gear.load import load_gear
from trawl_ros.lab.reference_codes.lone_line import SEA, WIRE, holding, lone_line, lying
from trawl_ros.lab.validation.cases import SECTIONS, load_case
from trawl_ros.lab.validation.closed_forms.board_law import compare_laws
from trawl_ros.lab.validation.closed_forms.catenary import END, START, elastic_catenary
from trawl_ros.lab.validation.closed_forms.energy_budget import WireHaul
from trawl_ros.lab.validation.closed_forms.power import WORKS, Ledger, strain_energy
from trawl_ros.model.bar import SLACK_WIDTH, SLACKEST_STRAIGHT
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.line import taut
from trawl_ros.model.state import State, Tow
from trawl_ros.solver.stepper import at_rest


@pytest.mark.parametrize('name', SECTIONS['closed_forms'])
def test_every_case_holds_in_small(name: str) -> None:
    outcome = load_case(name).run(True)
    assert [check for check in outcome.rows if not check.ok] == []
    assert len(outcome.rows) >= 3
    assert outcome.drawings
    assert all(len(row) == len(table.head) for table in outcome.tables for row in table.rows)


@pytest.mark.parametrize('key', ['c1', 'a2', 'b3', 'a4', 'b5', 'c6'])
def test_a_coefficient_that_is_off_by_a_millionth_is_seen(key: str) -> None:
    right = load_gear('kaifuha')
    values = right.board.coefficients.model_dump()
    wrong = right.board.coefficients.model_copy(update={key: values[key] * (1 + 1e-6)})
    board = right.board.model_copy(update={'coefficients': wrong})
    off = right.model_copy(update={'board': board})
    for gear, least, most in ((right, 0.0, 1e-10), (off, 1e-8, 1e-4)):
        found = compare_laws(gear, np.random.default_rng(1), within=True, paper=right)
        assert least <= max(found.force, found.moment) < most


def test_strain_energy_is_the_integral_of_the_strain_that_pulls() -> None:
    for strain in (-2e-4, -SLACK_WIDTH, -4e-5, 0.0, 7e-5, SLACK_WIDTH, 3e-4, 0.02):
        corners = (-SLACK_WIDTH, SLACK_WIDTH)
        wanted, _ = quad(lambda e: float(taut(np.array(e))[0]), -3e-4, strain, points=corners)
        assert float(strain_energy(np.array(strain))) == pytest.approx(wanted, rel=1e-9, abs=1e-18)


def test_the_catenary_ends_where_it_is_held_and_carries_its_weight() -> None:
    wire = elastic_catenary(50)
    np.testing.assert_allclose(wire.places[[0, -1]], [START, END], atol=1e-9)
    np.testing.assert_allclose(wire.pulls.sum(0), [0.0, 0.0, -28.0 * 480.0], atol=1e-9)


def test_a_haul_takes_in_its_wire_smoothly_and_within_the_winches_power() -> None:
    haul, gear = WireHaul(50.0, 300.0), load_gear('kaifuha')
    times = np.linspace(0.0, 300.0, 30_001)
    wire, rate = np.array([haul.hauled(t) for t in times]).T
    assert (wire[0], wire[-1]) == (0.0, pytest.approx(50.0))
    np.testing.assert_allclose(np.gradient(wire, times), rate, atol=1e-5)
    assert rate.max() == pytest.approx(gear.winch.max_speed_m_s)
    assert np.abs(np.gradient(rate, times)).max() < gear.winch.max_acceleration_m_s2


def lowered_line() -> tuple[GearModel, State, Tow]:
    """A slack level line of 200 m, sinking at 1 m/s with both ends held."""
    model = lone_line(WIRE, 5, SEA, 'at both ends')
    points = np.stack([np.linspace(0.0, 199.9, 6), np.zeros(6), np.full(6, -50.0)], axis=1)
    down = np.array([0.0, 0.0, -1.0])
    tow = holding(200.0, points[0], points[-1])
    return (
        model,
        lying(points[1:-1], down),
        replace(tow, block_velocities=np.tile(down, (2, 1))),
    )


def test_the_weight_of_a_sinking_line_is_read_off_its_height() -> None:
    model, state, tow = lowered_line()
    ledger, drop = Ledger.of(model), np.array([0.0, 0.0, -3.0])
    lower = replace(state, nodes=state.nodes + drop), replace(tow, blocks=tow.blocks + drop)
    gained = ledger.energies(*lower) - ledger.energies(state, tow)
    assert gained[1] == pytest.approx(-28.0 * 200.0 * 3.0)
    assert gained[[0, 2]] == pytest.approx([0.0, 0.0])


def test_drag_on_a_sinking_line_takes_the_power_of_its_law() -> None:
    model, state, tow = lowered_line()
    powers = dict(zip(WORKS, Ledger.of(model).powers(at_rest(state), tow), strict=True))
    # A slack line drags on the distance of its ends, as a part of where its slack begins.
    drag = 0.5 * 1025.0 * 1.2 * 0.032 * 199.9 / (200.0 * SLACKEST_STRAIGHT)
    assert powers.pop('ropes_drag') == pytest.approx(-drag * 200.0)
    # Either hold carries half of the bar of 40 m that hangs on it.
    assert powers.pop('ship') == pytest.approx((drag - 28.0) * 40.0)
    assert powers == pytest.approx(dict.fromkeys(powers, 0.0), abs=1e-9)


def test_what_winches_haul_takes_its_energy_along() -> None:
    model, state, tow = lowered_line()
    rate = -0.4
    hauled = replace(tow, length_rates=np.full(2, rate))
    powers = dict(zip(WORKS, Ledger.of(model).powers(at_rest(state), hauled), strict=True))
    assert powers['wire_placed'] == pytest.approx(-50.0 * 28.0 * rate)
    displaced = 1025.0 * np.pi / 4 * 0.032**2
    per_metre = 28.0 / 9.80665 + displaced
    # The halves at the two holds are no part of the line: four fifths of its mass move.
    assert powers['wire_moving'] == pytest.approx(0.5 * per_metre * rate * 0.8)
    assert powers['winches'] == 0.0
