"""The wheel, built from the sdist, works in a new environment and an empty folder."""

import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from promised.documents import read_document
from promised.story import ENDS, by_beginning, compare

ROOT = Path(__file__).resolve().parents[2]
TO_A_PICTURE_S = 90.0
"""Processor time from an empty environment and the wheel to a picture of a tow.

Three minutes on the clock of an idle machine leave as much for the package index.
"""

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

GUIDES = ('compare', 'swap_doors', 'own_gear')
"""Guides of a gear engineer, who has no ROS."""

Run = Callable[..., subprocess.CompletedProcess[str]]


class Installed(NamedTuple):
    """What runs commands in an empty folder, the cost of installing (s), and the environment."""

    run: Run
    seconds: float
    environment: Path


def processor_s() -> float:
    """Processor time of all commands that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@pytest.fixture(scope='module')
def wheel(source_workspace: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of a copy of this project."""
    folder = tmp_path_factory.mktemp('dist')
    uv = Path(sys.executable).with_name('uv')
    build = (uv, 'build', '--no-build-isolation', '--offline', '--python', sys.executable)
    done = subprocess.run(
        [*build, '--out-dir', folder, source_workspace / 'src' / 'trawl_ros'],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len(list(folder.glob('*.tar.gz'))) == 1
    (built,) = folder.glob('*.whl')
    return built


@pytest.fixture(scope='module')
def installed(
    wheel: Path,
    new_shell: Callable[[Path], dict[str, str]],
    tmp_path_factory: pytest.TempPathFactory,
) -> Installed:
    """The wheel in a new environment."""
    environment, folder = tmp_path_factory.mktemp('environment'), tmp_path_factory.mktemp('empty')
    begin = processor_s()
    subprocess.run([sys.executable, '-m', 'venv', environment], check=True)

    def run(command: str, *words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [environment / 'bin' / command, *words],
            cwd=folder, env=new_shell(folder), stdin=subprocess.DEVNULL,
            capture_output=True, text=True, check=False,
        )  # fmt: skip

    done = run('pip', 'install', '--quiet', str(wheel))
    if done.returncode and run('pip', 'download', '--no-deps', 'click').returncode:
        pytest.skip(f'no package index: {done.stderr.strip().splitlines()[-1]}')
    assert done.returncode == 0, done.stderr
    return Installed(run, processor_s() - begin, environment)


def test_the_second_command_draws_a_tow(installed):
    run, seconds, _ = installed
    begin = processor_s()
    done = run('trawl', 'plot', 'sea_trial', '--out', 'pictures')
    assert done.returncode == 0, done.stderr
    assert 'pictures/history.png' in done.stdout
    assert seconds + processor_s() - begin < TO_A_PICTURE_S


@pytest.mark.parametrize(
    'words',
    [
        ('bag', 'check', 'sea_trial'),
        ('gear', 'check', 'krill_800.yaml'),
        ('scenarios',),
        ('files', '--out', 'mine'),
    ],
    ids=' '.join,
)
def test_what_comes_with_the_package_is_there_by_name(installed, words):
    done = installed[0]('trawl', *words)
    assert done.returncode == 0, done.stderr


def test_a_scenario_of_the_sample_bag_is_there_by_name(installed):
    code = "import trawl_ros; print(trawl_ros.load_scenario('sea_trial.yaml').path)"
    done = installed[0]('python', '-c', code)
    assert Path(done.stdout.strip()).name == 'sea_trial.yaml', done.stderr


@pytest.mark.parametrize('words', [('sim_node',), ('nmea_in',), ('trawl', 'demo', '--out', 'demo')])
def test_without_ros_a_sentence_says_what_to_install(installed, words):
    done = installed[0](*words)
    assert done.returncode == 1
    (said,) = done.stderr.strip().splitlines()
    assert 'needs ROS 2 and found no rclpy' in said
    assert "pip install 'trawl_ros[ros]'" in said


def test_the_first_tow_says_why_it_takes_its_time(installed):
    done = installed[0]('trawl', 'gear', 'state', 'kaifuha', '--warp', '500', '--speed', '2.1')
    assert done.returncode == 0, done.stderr
    assert 'compiling the loops of the model' in done.stderr.splitlines()[0]
    assert 'compiled' in done.stderr.splitlines()[1]


@pytest.mark.parametrize('guide', GUIDES)
def test_a_guide_works_in_an_empty_folder(installed, new_shell, tmp_path, guide):
    document = read_document(ROOT / 'docs' / 'guides' / f'{guide}.md')
    for name, text in document.files.items():
        (tmp_path / name).write_text(text)
    programs = installed.environment / 'bin'
    shell = new_shell(tmp_path)
    for promise in document.promises:
        python = promise.language == 'python'
        program = ('python', '-c') if python else ('bash', '-eo', 'pipefail', '-c')
        done = subprocess.run(
            [*program, promise.text],
            cwd=tmp_path,
            env={**shell, 'PATH': f'{programs}{os.pathsep}{shell["PATH"]}'},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, check=False,
        )  # fmt: skip
        wanted = by_beginning(ENDS, promise.text, 0)
        assert done.returncode == wanted, f'{promise.place}\n{done.stdout}'
        if promise.printed is not None:
            lines = done.stdout.splitlines(keepends=True)
            compare(promise, ''.join(line for line in lines if not line.startswith('compil')))
