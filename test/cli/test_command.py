"""The command itself: its list, its version, and how it says no."""

import subprocess
import sys

import pytest

from trawl_ros.cli.main import COMMANDS
from trawl_ros.core.version import __version__


def test_the_list_of_commands_loads_none_of_them():
    code = (
        'import sys\n'
        'from trawl_ros.cli.main import main\n'
        'try:\n'
        '    main(["--help"])\n'
        'finally:\n'
        '    assert not {"numpy", "trawl_ros.cli.tow"} & sys.modules.keys()\n'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for name, (_, sentence) in COMMANDS.items():
        assert f'{name} ' in done.stdout
        assert sentence.split()[0] in done.stdout


@pytest.mark.parametrize('name', COMMANDS)
def test_every_command_explains_itself(run, name):
    done = run(name, '--help')
    assert done.exit_code == 0
    assert 'Usage:' in done.output


def test_version(run):
    assert run('--version').output == f'trawl, version {__version__}\n'


def test_usage_errors_end_with_2(run, tmp_path):
    assert run('no-such-command').exit_code == 2
    assert run('tow').exit_code == 2
    assert run('tow', 'demo').exit_code == 2
    assert run('identify', '--out', tmp_path).exit_code == 2


def test_scenarios_are_listed_with_what_they_are_for(run):
    done = run('scenarios')
    assert done.exit_code == 0
    assert 'demo' in done.stdout


@pytest.mark.parametrize('code', ['0', ''])
def test_foreign_code_that_leaves_does_not_end_a_command_as_done(run, monkeypatch, code):
    def leave(*_):
        sys.exit(*map(int, code))

    monkeypatch.setattr('trawl_ros.cli.effects.catalogue', leave)
    done = run('effects')
    assert done.exit_code == 1
    assert 'Traceback' not in done.output
