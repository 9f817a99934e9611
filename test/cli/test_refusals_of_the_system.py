"""What the system refuses ends a command with one sentence, and with no traceback."""

import subprocess
import sys
from pathlib import Path

import pytest

from trawl_ros.cli.main import printable, trawl

CODE = 'from trawl_ros.cli.main import main; main()'


def run(*arguments: object, folder: Path, stdout: str = '/dev/null') -> tuple[int, str]:
    """Run ``trawl`` in a process of its own; its exit code and standard error."""
    with open(stdout, 'w') as out:  # noqa: PTH123
        done = subprocess.run(
            [sys.executable, '-c', CODE, *map(str, arguments)],
            cwd=folder, stdout=out, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
    return done.returncode, done.stderr


@pytest.mark.parametrize('arguments', [['--help'], ['scenarios'], ['effects']])
def test_a_full_disk_behind_the_standard_output(arguments: list[str], tmp_path: Path) -> None:
    code, said = run(*arguments, folder=tmp_path, stdout='/dev/full')
    assert (code, said) == (1, 'Error: No space left on device\n')


@pytest.mark.parametrize('name', ['plot', 'validate'])
def test_a_folder_that_cannot_be_made(name: str, steady_tow, tmp_path: Path, capfd) -> None:
    bag = steady_tow.bag(tmp_path / 'bag', leg_s=30)
    arguments = ['--small'] if name == 'validate' else [str(bag)]
    (tmp_path / 'file').write_text('mine')
    with pytest.raises(SystemExit) as end:
        trawl.main([name, *arguments, '--out', str(tmp_path / 'file' / 'out')], prog_name='trawl')
    said = capfd.readouterr().err
    assert end.value.code
    assert 'Error: ' in said
    assert 'Traceback' not in said


def test_a_terminal_obeys_nothing_that_a_file_says() -> None:
    assert printable('a\x1b[2J\nb\r\x07é') == 'a?[2J\nb??é'
