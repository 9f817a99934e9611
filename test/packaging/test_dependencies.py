"""What a full ROS 2, rosdep and the guide's line of pip give is enough for every executable."""

import ast
import importlib.metadata as metadata
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path
from runpy import run_path
from unittest import mock

import pytest
from catkin_pkg.package import parse_package
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
OPTIONAL = {
    'websockets',
    'rerun',
    'rerun_cli',
    'moordyn',
    'moorpy',
    'trawlkit',
    'tf2_msgs',
    'pytest',
}
"""Of extras, looked for where they are used, and pytest, whose plugin only pytest loads."""

WITH_ANOTHER = {'pydantic_core': 'pydantic', '_typeshed': ''}
"""Modules that come with a distribution, or for type checkers alone."""

BLOCKED = """
import json, sys
blocked = set(json.loads(sys.stdin.read()))

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name in blocked:
            raise ModuleNotFoundError(f'{name} is not declared', name=name)

for name in [name for name in sys.modules if name.split('.')[0] in blocked]:
    del sys.modules[name]
sys.meta_path.insert(0, Blocker())
from importlib import import_module
for place in sys.argv[1:]:
    module, _, function = place.partition(':')
    assert callable(getattr(import_module(module), function)), place
"""


@pytest.fixture(scope='module')
def declared() -> dict:
    """The names in setup.py, and what it hands over to setuptools."""
    with mock.patch('setuptools.setup') as setup, pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        names = run_path(str(ROOT / 'setup.py'))
    return {**names, **setup.call_args.kwargs}


@pytest.fixture(scope='module')
def package():
    return parse_package(str(ROOT))


def install_requirements() -> list[str]:
    text = (ROOT / 'docs' / 'guides' / 'install.md').read_text(encoding='utf-8')
    (line,) = (
        line for line in text.splitlines() if line.startswith('pip install ') and 'dask' in line
    )
    return shlex.split(line)[2:]


def keys(dependencies) -> set[str]:
    return {dependency.name for dependency in dependencies}


def imported(folder: Path, *, skip: tuple[str, ...] = ()) -> dict[str, set[str]]:
    """Top-level modules that the files below a folder import, and the files."""
    found: dict[str, set[str]] = {}
    for file in sorted([folder] if folder.is_file() else folder.rglob('*.py')):
        for node in ast.walk(ast.parse(file.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names = [node.module]
            else:
                continue
            for name in names:
                found.setdefault(name.split('.')[0], set()).add(str(file.relative_to(ROOT)))
    return {
        name: files
        for name, files in found.items()
        if name not in sys.stdlib_module_names and name not in ('trawl_ros', *skip)
    }


def distributions_of(module: str) -> set[str]:
    by_module = metadata.packages_distributions()
    return {canonicalize_name(name) for name in by_module.get(module, [module])}


def closure(names: set[str]) -> set[str]:
    """Distributions, with all that they need themselves."""
    found: set[str] = set()
    waiting = {canonicalize_name(name) for name in names}
    while waiting:
        name = waiting.pop()
        found.add(name)
        for text in metadata.requires(name) or ():
            needed = Requirement(text)
            if needed.marker is None or needed.marker.evaluate({'extra': ''}):
                waiting |= {canonicalize_name(needed.name)} - found
    return found


def test_each_import_of_the_package_is_declared(declared, package):
    requirements = {
        canonicalize_name(Requirement(text).name) for text in declared['install_requires']
    }
    of_ros = keys(package.exec_depends)
    for module, files in imported(ROOT / 'trawl_ros').items():
        if module in OPTIONAL or module in of_ros:
            continue
        wanted = WITH_ANOTHER.get(module, module)
        assert not wanted or distributions_of(wanted) & requirements, f'{module}: {sorted(files)}'


def test_package_xml_names_the_rosdep_keys_of_setup_py(declared, package):
    python = {key for key in keys(package.exec_depends) if key.startswith('python3-')}
    assert python == set(declared['BY_ROSDEP'].values())


def test_the_guide_has_pip_install_the_rest_into_an_environment_that_sees_ros(declared):
    assert install_requirements() == declared['BY_PIP']
    text = (ROOT / 'docs' / 'guides' / 'install.md').read_text(encoding='utf-8')
    assert 'python3 -m venv --system-site-packages .venv' in text


def test_packages_of_ros_are_the_same_for_rosdep_and_for_pip(declared, package):
    by_pip = {
        Requirement(text).name.removeprefix('ros-jazzy-').replace('-', '_')
        for text in declared['ROS']
    }
    by_rosdep = {key for key in keys(package.exec_depends) if not key.startswith('python3-')}
    # The middleware comes with a full ROS 2, the rest with nothing else.
    alone = {'launch', 'launch_ros', 'robot_state_publisher', 'tf2_msgs'}
    assert by_pip - {'rmw_fastrtps_cpp'} == by_rosdep - alone
    kilted = {Requirement(text).name.replace('kilted', 'jazzy') for text in declared['KILTED']}
    assert kilted == {Requirement(text).name for text in declared['ROS']}


def test_every_executable_can_be_imported_with_what_is_declared_alone(declared, package):
    pytest.importorskip('rclpy', reason='needs ROS 2, from the system or the extra `ros`')
    by_key = {key: Requirement(text).name for text, key in declared['BY_ROSDEP'].items()}
    of_ros = keys(package.exec_depends) - by_key.keys()
    names = {by_key[key] for key in keys(package.exec_depends) & by_key.keys()}
    names |= {Requirement(text).name for text in install_requirements()}
    # ROS 2 itself is there as its own packages need it.
    given = closure(names) | {'trawl-ros'}
    blocked = [
        module
        for module, owners in metadata.packages_distributions().items()
        if not {canonicalize_name(owner) for owner in owners} & given
        and not any(owner.startswith(('ros_', 'ros-', 'rclpy')) for owner in owners)
        and module not in of_ros
    ]
    assert 'moorpy' in blocked
    places = [entry.split('=')[1].strip() for entry in declared['entry_points']['console_scripts']]
    done = subprocess.run(
        [sys.executable, '-c', BLOCKED, *places],
        input=json.dumps(blocked),
        capture_output=True, text=True, check=False, cwd=ROOT, timeout=120.0,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


def test_what_colcon_test_runs_needs_no_more_than_package_xml_and_the_readme_give(
    declared, package
):
    text = (ROOT / 'pyproject.toml').read_text(encoding='utf-8')
    (listed,) = re.findall(r'testpaths = \[(.*?)\]', text, flags=re.S)
    requirements = {
        canonicalize_name(Requirement(text).name) for text in declared['install_requires']
    }
    given = {key.removeprefix('python3-') for key in keys(package.test_depends)}
    places = re.findall(r"'([^']+)'", listed)
    for place in ('test/conftest.py', 'test/nodes/conftest.py', *places):
        for module, files in imported(ROOT / place, skip=('hostile',)).items():
            if module in OPTIONAL or module in keys(package.exec_depends) or module in given:
                continue
            known = distributions_of(module) & requirements
            assert known, f'{module}: {sorted(files)}'
