"""The way of a gear engineer without ROS, in an empty folder: own gear, own log, another door."""

import csv
import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from trawl_ros import build_model, load_gear, steady_state
from trawl_ros.cli.main import trawl

LEGS = ((100.0, 4.5), (120.0, 4.5), (120.0, 4.1), (137.0, 4.1))
"""Fathoms of warp and knots of steady states, as a bridge notes them."""

FATHOM, KNOT, TONNE = 1.8288, 1852.0 / 3600.0, 9806.65
LEG_S = 480

Run = Callable[..., Result]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run ``trawl`` in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def command(line: str) -> Result:
        return CliRunner().invoke(trawl, shlex.split(line))

    return command


@pytest.fixture
def own_gear(run: Run) -> Path:
    """A gear file of their own: a copy of one of the package, with a coarse net."""
    assert run('gear copy kaifuha mine.yaml').exit_code == 0
    path = Path('mine.yaml')
    path.write_text(path.read_text().replace('around: 48', 'around: 12'))
    return path


def write_log(path: Path, gear: Path) -> None:
    """Write a synthetic log, 6 % narrower, 7 % heavier and 5 % deeper than the gear file says."""
    model, near, draws = build_model(load_gear(gear)), None, np.random.default_rng(3)
    sides = ('Port', 'Starboard')
    heads = ['Time', *(f'{s} warp (fm)' for s in sides), *(f'{s} load (t)' for s in sides),
             *(f'{s} door depth (m)' for s in sides), 'Door spread (m)', 'Log (kn)']  # fmt: skip
    with path.open('w', newline='') as file:
        table = csv.writer(file)
        table.writerow(heads)
        for leg, (length, speed) in enumerate(LEGS):
            found = steady_state(model, length * FATHOM, speed * KNOT, start=near)
            near, seen = found.equilibrium, found.observables
            tensions = (1.07 * seen.port_tension, 1.07 * seen.starboard_tension)
            depths = (1.05 * seen.port_door_depth, 1.05 * seen.starboard_door_depth)
            truth = [length, length, *(t / TONNE for t in tensions), *depths,
                     0.94 * seen.door_spread, speed]  # fmt: skip
            noise = np.array([0.01, 0.01, 0.05, 0.05, 0.2, 0.2, 0.3, 0.02])
            for second in range(leg * LEG_S, (leg + 1) * LEG_S, 2):
                row = np.array(truth) + noise * draws.normal(size=len(noise))
                clock = f'2026-08-01 {12 + second // 3600}:{second // 60 % 60:02}:{second % 60:02}'
                table.writerow([clock, *(f'{value:.3f}' for value in row)])


@pytest.mark.usefixtures('rough_pictures')
def test_a_log_is_drafted_imported_and_held_against_the_gear_as_it_is(run: Run, own_gear: Path):
    write_log(Path('log.csv'), own_gear)
    draft = run('import-log log.csv --draft')
    assert draft.exit_code == 0, draft.output
    assert 'not recognised' not in draft.output
    Path('log.yaml').write_text(draft.output)
    done = run('compare log.csv --mapping log.yaml --gear mine.yaml --units sea --out page')
    assert done.exit_code == 0, done.output
    off = {
        line.split('  ')[0]: line.split()[-4]
        for line in done.stdout.splitlines()
        if line.split()[-1] == str(len(LEGS))
    }
    for channel, percent in {
        'door spread': -6.0, 'port tension': 7.0, 'starboard tension': 7.0,
        'port door depth': 5.0, 'starboard door depth': 5.0,
    }.items():  # fmt: skip
        assert float(off[channel].replace('−', '-')) == pytest.approx(percent, abs=0.4), channel
    assert ' t ' in done.stdout
    assert 'trawl identify log.csv' in done.stdout
    assert Path('page/comparison.html').is_file()


def test_all_mistakes_of_a_mapping_are_told_at_once(run: Run):
    Path('log.csv').write_text('s,warp,spread\n0,500,150\n')
    Path('log.yaml').write_text(
        "clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}\n"
        'topics:\n'
        '  winch/joint_states: {fields: {port_lenght: {column: warp, unit: m}}}\n'
        '  door/spread: {fields: {distance: {column: spread, unit: parsec}}}\n'
        '  door/spraed: {fields: {distance: {column: spread, unit: m}}}\n'
    )
    done = run('import-log log.csv --mapping log.yaml --out bag')
    assert done.exit_code == 1
    for word in ('port_lenght', 'parsec', 'door/spraed'):
        assert word in done.stderr
    assert not Path('bag').exists()


def test_another_door_is_fitted_or_refused_with_what_is_needed(run: Run, own_gear: Path):
    done = run('gear set-door mine.yaml low_aspect_cambered --warp 270fm --speed 4.1kn --units sea')
    assert done.exit_code == 0, done.output
    before, now = done.stdout.splitlines()[:2]
    assert before.startswith('before: at 493.776 m and 4.10 kn')
    assert ' kn: α' in now
    assert ' t; ' in now
    assert run('gear state mine.yaml --warp 500 --speed 2.1').exit_code == 0
    text = own_gear.read_text()
    refused = run('gear set-door mine.yaml no_such_door --warp 500 --speed 2.1')
    assert refused.exit_code == 1
    assert 'low_aspect_cambered' in refused.stderr
    assert own_gear.read_text() == text


def test_files_that_are_not_there_are_named_with_those_that_are(run: Run):
    Path('log.csv').write_text('s,warp,spread\n0,500,150\n')
    for line, words in (
        ('compare sea_trail --gear kaifuha', ('sea_trail',)),
        ('gear state kaifuah --warp 500 --speed 2.1', ('kaifuah', 'kaifuha')),
        ('gear check none.yaml', ('none.yaml',)),
        ('gear set-door kaifuha high_lift --warp 500 --speed 2.1', ('trawl gear copy',)),
        ('compare log.csv --gear kaifuha', ('log.csv', 'trawl import-log LOG --draft')),
        ('gear state kaifuha --warp 500 --speed 4tonnes', ('tonnes', 'kn')),
    ):
        done = run(line)
        assert done.exit_code in (1, 2), line
        assert all(word in done.stderr for word in words), done.stderr
