"""What the system refuses ends a command with one sentence, and with no traceback."""

import errno
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

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
    assert (code, said) == (1, f'Error: {os.strerror(errno.ENOSPC)}\n')


@pytest.mark.parametrize(
    'place', ['{folder}/file/out', '{folder}/file', '/proc/out', '/dev/full/out']
)
@pytest.mark.parametrize(
    'words',
    [
        'tow nowhere', 'identify nowhere', 'diagnose nowhere', 'plan-trial nowhere',
        'plot nowhere', 'bag export nowhere', 'import-log {log} --mapping door_test_haul_log',
        'validate', 'benchmark', 'demo',
    ],
)  # fmt: skip
def test_a_folder_that_cannot_be_written_is_told_before_the_work(words, place, tmp_path) -> None:
    (tmp_path / 'file').write_text('mine')
    (tmp_path / 'log.csv').write_text('a log')
    before = sorted(tmp_path.rglob('*'))
    out = place.format(folder=tmp_path)
    words = words.format(log=tmp_path / 'log.csv').split()
    began = time.monotonic()
    done = CliRunner().invoke(trawl, [*words, '--out', out])
    assert time.monotonic() - began < 20.0
    assert done.exit_code in (1, 2), done.output
    assert out in done.stderr
    assert sorted(tmp_path.rglob('*')) == before
    assert (tmp_path / 'file').read_text() == 'mine'


def test_a_terminal_obeys_nothing_that_a_file_says() -> None:
    assert printable('a\x1b[2J\nb\r\x07é') == 'a?[2J\nb??é'
