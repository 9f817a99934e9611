"""Trim over a range: the attitude changes little with speed and warp length."""

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.gear.load import load_gear
from trawl_ros.model.assembly import forces
from trawl_ros.model.gear_model import GearModel, build_model
from trawl_ros.solver.equilibrium import find_equilibrium, steady_state
from trawl_ros.solver.operating_point import OperatingPoint
from trawl_ros.solver.relax import relax, without_attitude
from trawl_ros.solver.trimming.held_boards import WAYS, held_board
from trawl_ros.solver.trimming.measured import angles_from
from trawl_ros.solver.trimming.over_range import RangeTrim, trim_over_range

MIRROR = np.array([-1.0, 1.0, -1.0])
"""Signs of the starboard board's rotation vector if the port board rotates by it, mirrored."""

WARPS, SPEEDS = (300.0, 700.0), (1.1, 1.8)


@pytest.fixture(scope='module')
def krill() -> GearModel:
    gear = load_gear('krill_800')
    netting = gear.netting.model_copy(update={'around': 24})
    return build_model(gear.model_copy(update={'netting': netting}))


@pytest.fixture(scope='module')
def trimmed(krill: GearModel) -> RangeTrim:
    return trim_over_range(
        krill,
        attack=np.radians(16.0),
        inclination=np.radians(8.0),
        warp_lengths=WARPS,
        speeds=SPEEDS,
    )


def test_moment_and_stiffness_of_a_held_board_are_those_of_the_gear(krill: GearModel) -> None:
    model = krill.with_board(installation=(0.05, 0.02, -0.03))
    found = find_equilibrium(model, OperatingPoint(500.0, 500.0, 1.2))
    board, free = held_board(model, found.state, found.tow), without_attitude(model)
    moment, stiffness = board.balance(board.arms)
    assert np.abs(moment).max() < 1e-3
    # Small turns of both boards either way, alike and against each other, the rest at rest again.
    n, turn = 3 * model.nodes, 1e-4

    def turned(way: float, axis: int, angle: float) -> np.ndarray:
        step = np.zeros(model.dof)
        step[n + 3 + axis], step[n + 9 + axis] = angle, way * angle * MIRROR[axis]
        state, *_ = relax(
            model, found.state.moved(step), found.tow, tolerance=1e-5, time_step=1e3, free=free
        )
        return forces(model, state, found.tow)[n + 3 : n + 6]

    for way, stiff in zip(WAYS, stiffness, strict=True):
        for axis in range(3):
            slope = (turned(way, axis, turn) - turned(way, axis, -turn)) / (2.0 * turn)
            assert -slope == pytest.approx(stiff[:, axis], rel=1e-3, abs=5.0)
    # Other points, by millimetres.
    moved = model.with_board(
        points=model.board.points + 1e-3 * np.random.default_rng(0).normal(size=(3, 3))
    )
    state, *_ = relax(moved, found.state, found.tow, tolerance=1e-5, time_step=1e3, free=free)
    arms = moved.board.fastening_points @ found.state.board_rotations[0].T
    left = forces(moved, state, found.tow)[n + 3 : n + 6]
    assert board.balance(arms)[0] == pytest.approx(left, rel=1e-3)


@pytest.mark.slow
def test_inclination_changes_by_a_third_of_what_it_did(
    krill: GearModel, trimmed: RangeTrim
) -> None:
    assert trimmed.usable == len(WARPS) * len(SPEEDS)
    before = [steady_state(krill, WARPS[0], speed).observables.port_inclination for speed in SPEEDS]
    assert trimmed.by_speed[1] < abs(before[1] - before[0]) / 3.0
    assert trimmed.slowest < 0.0


@pytest.mark.slow
def test_angles_are_near_those_wanted(trimmed: RangeTrim) -> None:
    for point in trimmed.found:
        assert point.steady is not None
        seen = point.steady.observables
        assert np.degrees(seen.port_attack) == pytest.approx(16.0, abs=4.0)
        assert np.degrees(seen.port_inclination) == pytest.approx(8.0, abs=6.0)


@pytest.mark.slow
def test_states_between_are_usable_when_found_from_nothing(trimmed: RangeTrim) -> None:
    seen = steady_state(trimmed.model, 500.0, 1.4).observables
    assert np.degrees(seen.port_attack) == pytest.approx(16.0, abs=4.0)


@pytest.mark.slow
def test_each_point_of_a_range_is_usable_and_the_attitude_changes_little(model: GearModel) -> None:
    found = trim_over_range(
        model,
        attack=np.radians(20.0),
        inclination=np.radians(12.0),
        warp_lengths=(400.0,),
        speeds=(2.2, 2.6),
    )
    assert found.usable == 2
    assert np.degrees(found.by_speed).max() < 3.0


@pytest.mark.slow
def test_boards_whose_upper_edge_leans_outward_go_deeper(model: GearModel) -> None:
    depths = []
    for lean in (-6.0, 12.0):
        found = trim_over_range(
            model,
            attack=np.radians(20.0),
            inclination=np.radians(lean),
            warp_lengths=(400.0,),
            speeds=(2.2, 2.6),
        )
        assert found.usable == 2
        depths.append(found.found[0].steady.observables.door_depth)
    assert depths[0] > 1.2 * depths[1]


@pytest.mark.slow
def test_a_net_whose_twine_flips_finds_its_shapes_under_a_load() -> None:
    found = trim_over_range(
        build_model(load_gear('harstad_1436')),
        attack=np.radians(16.0),
        inclination=np.radians(8.0),
        warp_lengths=(200.0, 500.0),
        speeds=(1.2, 2.0),
    )
    assert found.usable == 4
    assert np.degrees(found.by_speed[1]) < 10.0


def test_measured_spread_and_depth_give_the_angles_of_their_state(model: GearModel) -> None:
    seen = steady_state(model, 500.0, 2.1).observables
    found = angles_from(
        model,
        spread=seen.door_spread,
        depth=seen.door_depth,
        warp_length=500.0,
        speed=2.1,
        pitch=seen.port_pitch,
    )
    assert found.met
    assert found.attack == pytest.approx(seen.port_attack, abs=np.radians(1.0))
    assert found.inclination == pytest.approx(seen.port_inclination, abs=np.radians(2.0))
    assert '1.00 times the measured' in found.told(seen.warp_tension)


def test_a_wish_that_cannot_be_met_is_told_with_the_nearest(model: GearModel) -> None:
    found = angles_from(model, spread=400.0, depth=100.0, warp_length=500.0, speed=2.1)
    assert not found.met
    assert all(figure in found.told() for figure in (' 400 m', ' 100 m', found.missed))


@pytest.mark.parametrize(
    'options',
    [[], ['--attack', '20'], ['--spread', '90', '--attack', '20', '--inclination', '10']],
)
def test_half_a_wish_is_refused(options: list[str]) -> None:
    result = CliRunner().invoke(trawl, ['trim', 'krill_800', *options])
    assert result.exit_code == 2
    assert all(name in result.output for name in ('--attack', '--spread'))


def test_a_tension_without_spread_and_depth_is_refused() -> None:
    options = ['--attack', '20', '--inclination', '10', '--tension', '150']
    result = CliRunner().invoke(trawl, ['trim', 'krill_800', *options])
    assert result.exit_code == 2
    assert '--tension' in result.output


def test_the_command_prints_points_and_what_they_give(
    coarse_gear: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Lines of progress come every 10 s, and a fast machine is done before the first.
    monkeypatch.setattr('trawl_ros.cli.console.progress.LINE_EVERY_S', 0.0)
    result = CliRunner().invoke(
        trawl,
        ['trim', str(coarse_gear), '--attack', '20', '--inclination', '12', '--warp', '400']
        + ['--speeds', '2.0', '2.4'],
    )
    assert result.exit_code == 0, result.output
    assert 'riggings: 0 of 3' in result.stderr
    lines = result.stdout.splitlines()
    assert [line.split(':')[0].strip() for line in lines[:4]] == [
        'fastening',
        'warp_m',
        'upper_bridle_m',
        'lower_bridle_m',
    ]
    assert sum(line.startswith('# at 400 m') for line in lines) == 3
    wanted = '# wanted α 20.0° and δ 12.0°; nearest over the range: α '
    assert sum(line.startswith(wanted) for line in lines) == 1
    assert '3 of 3 are usable' in lines[-1]
