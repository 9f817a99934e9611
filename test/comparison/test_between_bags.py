"""Two bags compared, aligned by state and in time; all bags are synthetic."""

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from trawl_ros.api.comparing import compare_bags
from trawl_ros.cli.main import trawl
from trawl_ros.comparison.between_bags import Alignment
from trawl_ros.core.errors import TrawlError

HOUR_NS = 3_600_000_000_000


@pytest.fixture(scope='module')
def other(changed_log) -> Path:
    """The same tow on another day, with other noise."""
    path: Path = changed_log({}, seed=8, start=30 * HOUR_NS)
    return path


@pytest.mark.parametrize(('by', 'rows'), [('state', 4), ('time', 7)])
def test_what_differs_is_found_by_state_and_in_time(
    off_log: Path, other: Path, coarse_gear: Path, by, rows: int
) -> None:
    found = compare_bags(off_log, other, by=by, gear=coarse_gear)
    assert len(found.states) == rows
    off = {sensor.channel: sensor.relative for sensor in found.sensors}
    assert off['door_spread'] == pytest.approx(-0.06, abs=0.003)
    assert off['port_tension'] == pytest.approx(0.07, abs=0.003)
    assert off['port_length'] == pytest.approx(0.0, abs=1e-6)
    assert not found.verdict.agrees
    assert found.verdict.step == 'compare'


@pytest.mark.usefixtures('rough_pictures')
def test_a_bag_agrees_with_a_repetition(changed_log, other: Path, tmp_path: Path) -> None:
    again = changed_log({}, seed=9)
    out = tmp_path / 'out'
    words = ['bag', 'compare', str(again), str(other), '--units', 'sea', '--out', str(out)]
    done = CliRunner().invoke(trawl, words, catch_exceptions=False)
    assert done.exit_code == 0
    assert json.loads((out / 'comparison.json').read_text())['verdict']['agrees']
    assert ' kn ' in done.output
    assert ' t ' in done.output


def test_a_shift_moves_the_second(off_log: Path, other: Path, coarse_gear: Path) -> None:
    shifted = Alignment(shift_s=0.0)
    with pytest.raises(TrawlError, match='in common'):
        compare_bags(off_log, other, by='time', alignment=shifted, gear=coarse_gear)
    back = Alignment(shift_s=-30.0 * 3600.0)
    found = compare_bags(off_log, other, by='time', alignment=back, gear=coarse_gear)
    assert len(found.states) == 7


def test_states_that_are_not_equal_are_not_paired(
    off_log: Path, steady_tow, coarse_gear: Path, tmp_path: Path
) -> None:
    from dataclasses import replace

    shorter = replace(steady_tow, states=((120.0, 2.3, steady_tow.states[0][2]),))
    bag = shorter.bag(tmp_path / 'bag', leg_s=480)
    with pytest.raises(TrawlError, match='equal warp and speed'):
        compare_bags(off_log, bag, gear=coarse_gear)
