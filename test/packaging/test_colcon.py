"""`colcon build` makes of the checkout what `ros2 run` and `ros2 launch` look for."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from catkin_pkg.package import parse_package

ROOT = Path(__file__).resolve().parents[2]
EXECUTABLES = {
    'sim_node',
    'winch_node',
    'door_sensor_node',
    'trawl_sonar_node',
    'vessel_node',
    'autotrawl_node',
    'autopilot_node',
    'trial_node',
    'identification_node',
    'discrepancy_node',
    'bag_recorder',
    'bag_player',
    'nmea_in',
    'nmea_out',
    'foxglove_node',
    'view_node',
    'tether_node',
    'trawl',
}


def python(workspace, code: str) -> str:
    """Run a line of Python as a user of the sourced workspace, away from the checkout."""
    done = subprocess.run(
        [sys.executable, '-c', code],
        cwd=workspace.folder,
        env=workspace.environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def files_below(folder: Path) -> set[Path]:
    return {file.relative_to(folder) for file in folder.rglob('*') if file.is_file()}


def test_package_xml_is_valid():
    warnings: list[str] = []
    package = parse_package(str(ROOT), warnings=warnings)
    package.validate(warnings=warnings)
    assert warnings == []
    assert package.package_format == 3
    assert package.licenses == ['Apache-2.0']


def test_colcon_takes_it_for_a_ros_package(source_workspace: Path, colcon: Callable[..., str]):
    name, path, kind = colcon(source_workspace, 'list').split()
    assert (name, path, kind) == ('trawl_ros', str(Path('src/trawl_ros')), '(ros.ament_python)')


def test_executables_lie_where_ros2_run_looks(workspace):
    found = {file.name for file in workspace.executables.iterdir()}
    assert found == EXECUTABLES
    assert all(os.access(workspace.executables / name, os.X_OK) for name in found)


@pytest.mark.parametrize('name', sorted(EXECUTABLES))
def test_executables_run_with_the_python_that_built_them(workspace, name):
    first = (workspace.executables / name).read_text().splitlines()[0]
    assert first.startswith('#!')
    assert Path(first[2:].split()[0]).parent == Path(sys.executable).parent


def test_both_declarations_state_the_same_version(workspace):
    version = python(workspace, "import importlib.metadata as m; print(m.version('trawl_ros'))")
    assert version == parse_package(str(ROOT)).version


def test_the_ament_index_finds_the_package(workspace):
    share = python(
        workspace,
        'from ament_index_python.packages import get_package_share_directory as share; '
        "print(share('trawl_ros'))",
    )
    assert Path(share) == workspace.prefix / 'share' / 'trawl_ros'
    assert (Path(share) / 'package.xml').is_file()


def test_the_share_look_up_finds_the_installed_data_and_not_the_checkout(workspace):
    share = python(
        workspace, 'from trawl_ros.core.resources import share_path; print(share_path())'
    )
    assert Path(share) == workspace.prefix / 'share' / 'trawl_ros'


def test_all_data_are_installed_in_their_sub_folders(workspace):
    def data(share: Path) -> set[Path]:
        folders = ('config', 'bags', 'launch')
        return {file for file in files_below(share) if file.parts[0] in folders}

    wanted = data(workspace.folder / 'src' / 'trawl_ros')
    assert Path('config/gear/kaifuha.yaml') in wanted
    assert data(workspace.prefix / 'share' / 'trawl_ros') == wanted


def test_every_module_of_the_checkout_is_installed(workspace):
    site = python(workspace, 'import trawl_ros; print(trawl_ros.__path__[0])')
    assert Path(site).is_relative_to(workspace.prefix)
    built = {file for file in files_below(Path(site)) if file.suffix == '.py'}
    source = files_below(workspace.folder / 'src' / 'trawl_ros' / 'trawl_ros')
    assert built == {file for file in source if file.suffix == '.py'}
