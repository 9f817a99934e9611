"""Trim in motion: candidates have the wanted angles, and boards lean less than with the start."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from trawl_ros.cli.main import trawl
from trawl_ros.model.gear_model import GearModel
from trawl_ros.simulation.command import Command
from trawl_ros.simulation.random_commands import CommandLimits, RandomCommands
from trawl_ros.simulation.trim_in_motion import OPTIONS, trim_in_motion
from trawl_ros.solver.equilibrium import steady_state
from trawl_ros.solver.trimming.held_gear import coarsest_model
from trawl_ros.solver.trimming.over_range import hole_limits

SHORT = replace(
    OPTIONS, candidates=4, per_generation=4, calm_seeds=(1001,), calm_s=30.0, swell_s=5.0
)
WARPS, SPEEDS = (300.0, 500.0), (1.9, 2.3)


def test_the_best_candidate_has_the_wanted_angles_and_leans_no_more(model: GearModel) -> None:
    middle = np.sqrt(300.0 * 500.0), np.sqrt(1.9 * 2.3)
    coarse = coarsest_model(model)
    first = steady_state(coarse, *middle).observables
    wanted = {'attack': first.port_attack, 'inclination': first.port_inclination}
    found = trim_in_motion(
        model,
        **wanted,
        pitch=first.port_pitch,
        warp_lengths=WARPS,
        speeds=SPEEDS,
        options=SHORT,
    )
    assert found.lean < 1.1 * found.first_lean
    assert (np.abs(found.points) <= hole_limits(model.board) + 1e-9).all()
    seen = steady_state(coarse.with_board(points=found.points), *middle).observables
    assert seen.port_attack == pytest.approx(wanted['attack'], abs=0.02)
    assert seen.port_inclination == pytest.approx(wanted['inclination'], abs=0.02)


def test_random_commands_keep_their_limits() -> None:
    limits = CommandLimits(warps=(200.0, 400.0), speeds=(1.6, 2.4))
    commands = RandomCommands(np.random.default_rng(5), limits)
    before = Command(300.0, 300.0, 2.0)
    for time in np.arange(0.0, 7200.0, 5.0):
        now = commands.after(before, float(time))
        assert 200.0 <= now.port_length <= 400.0
        assert abs(now.starboard_length / now.port_length - 1.0) <= limits.uneven
        assert abs(now.speed - before.speed) <= limits.speed_step
        assert 1.6 <= now.speed <= 2.4
        assert abs(now.turn_rate) <= limits.turn_rate
        before = now


@pytest.mark.parametrize(
    'options',
    [
        ['--attack', '16', '--inclination', '14', '--warps', '200', '400'],
        ['--spread', '110', '--depth', '80', '--warps', '200', '400', '--speeds', '1.8', '2.4'],
    ],
)
def test_in_motion_without_a_range_or_angles_is_refused(options: list[str]) -> None:
    result = CliRunner().invoke(trawl, ['trim', 'kaifuha', *options, '--in-motion'])
    assert result.exit_code == 2
    assert '--in-motion' in result.output
