"""A scratch workspace in which the package is built by colcon, once per test process."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOT_SOURCE = ('.*', 'out', 'build', 'install', 'log', 'dist', '__pycache__', '*.egg-info')

# What a shell may have sourced before: the workspace has to work without any of it.
SOURCED = (
    'AMENT_PREFIX_PATH',
    'CMAKE_PREFIX_PATH',
    'COLCON_PREFIX_PATH',
    'PYTHONPATH',
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE',
)


@dataclass(frozen=True)
class Workspace:
    """A colcon workspace: its folder, and the environment after sourcing what it installed."""

    folder: Path
    environment: dict[str, str]

    @property
    def prefix(self) -> Path:
        return self.folder / 'install' / 'trawl_ros'

    @property
    def executables(self) -> Path:
        return self.prefix / 'lib' / 'trawl_ros'


def clean_environment(folder: Path) -> dict[str, str]:
    """The environment of a new shell, with colcon's own notes kept in `folder`."""
    environment = {key: value for key, value in os.environ.items() if key not in SOURCED}
    return {**environment, 'COLCON_HOME': str(folder / '.colcon')}


@pytest.fixture(scope='session')
def new_shell() -> Callable[[Path], dict[str, str]]:
    """The environment of a new shell, by a folder of its own."""
    return clean_environment


@pytest.fixture(scope='session')
def colcon() -> Callable[..., str]:
    """Run colcon with the Python of this test run, since what it installs runs with the same."""
    beside = Path(sys.executable).parent
    program = shutil.which('colcon', path=f'{beside}{os.pathsep}{os.environ["PATH"]}')
    assert program, 'colcon is needed here; the extra `test` of setup.py brings it'

    def run(workspace: Path, *arguments: str) -> str:
        done = subprocess.run(
            [program, *arguments],
            cwd=workspace,
            env=clean_environment(workspace),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


@pytest.fixture(scope='session')
def source_workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that holds nothing but a copy of this project in src/."""
    folder = tmp_path_factory.mktemp('workspace')
    shutil.copytree(ROOT, folder / 'src' / 'trawl_ros', ignore=shutil.ignore_patterns(*NOT_SOURCE))
    return folder


def install_line(beginning: str) -> str:
    """The line of the install guide's blocks of commands that begins so."""
    lines = (ROOT / 'docs' / 'guides' / 'install.md').read_text(encoding='utf-8').splitlines()
    (found,) = (line for line in lines if line.startswith(beginning))
    return found


@pytest.fixture(scope='session')
def workspace(source_workspace: Path) -> Workspace:
    """The workspace after what the guide says to build and source it."""
    environment = clean_environment(source_workspace)
    beside = Path(sys.executable).parent
    sourced = subprocess.run(
        ['bash', '-c', f'{{ {install_line("python3 -m colcon build")}; }} >&2 && env -0'],
        cwd=source_workspace,
        env={**environment, 'PATH': f'{beside}{os.pathsep}{environment["PATH"]}'},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert sourced.returncode == 0, sourced.stderr
    variables = dict(line.split('=', 1) for line in sourced.stdout.split('\0') if line)
    return Workspace(source_workspace, variables)
