"""The layers hold, are noticed where they do not, and are those of docs/design.md."""

import ast
import os
import runpy
import shutil
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).parents[1]
LAYERS = runpy.run_path(str(Path(__file__).with_name('layers.py')))
MOST = 21
"""Modules of a folder, beside its folders."""


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    """Hold the copy of the package in a folder to the contracts."""
    return subprocess.run(
        [Path(sys.executable).with_name('lint-imports'), '--no-cache'],
        cwd=folder,
        env={**os.environ, 'PYTHONPATH': str(folder), 'COLUMNS': '200'},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    shutil.copytree(
        ROOT / 'trawl_ros', tmp_path / 'trawl_ros', ignore=shutil.ignore_patterns('__pycache__')
    )
    shutil.copy(ROOT / 'pyproject.toml', tmp_path)
    return tmp_path


def test_the_imports_keep_the_contracts() -> None:
    done = lint(ROOT)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize(
    ('module', 'line', 'broken'),
    [
        ('gear/load.py', 'from trawl_ros.model.board import COEFFICIENTS', 'Rooms import only'),
        ('solver/trim.py', 'import trawl_ros.lab.validation.cases', 'Rooms import only'),
        ('nodes/sim_node.py', 'import trawl_ros.cli.main', 'Rooms import only'),
        ('estimation/windows/finder.py', 'import trawl_ros.estimation.fit.fit', 'Estimation goes'),
        (
            'diagnosis/repair.py',
            'import trawl_ros.estimation.least_squares.descent',
            'Only a fit steps',
        ),
        ('effects/base/effect.py', 'import trawl_ros.effects.registry', 'No cycle'),
        ('solver/trim.py', 'import rclpy', 'know rclpy'),
        ('diagnosis/repair.py', 'import click', 'know click'),
    ],
)
def test_an_import_upward_is_noticed(tree: Path, module: str, line: str, broken: str) -> None:
    path = tree / 'trawl_ros' / module
    path.write_text(f'{path.read_text(encoding="utf-8")}\n{line}\n', encoding='utf-8')
    done = lint(tree)
    assert done.returncode == 1
    (said,) = (row for row in done.stdout.splitlines() if broken in row and 'BROKEN' in row)
    assert said


SOLVERS = {'curve_fit', 'least_squares', 'leastsq', 'lsq_linear', 'nnls'}
"""Functions of scipy.optimize that step in least squares."""

STEPS = {
    'estimation/least_squares/linear_problem.py',
    # Gear is trimmed to what is measured of it: no fit of readings.
    'solver/trimming/measured.py', 'solver/trimming/released.py', 'solver/trimming/traded.py',
}  # fmt: skip
"""Modules that may use them."""


def _steps(path: Path) -> bool:
    """Tell whether a module imports a least-squares step of SciPy, or names one as an attribute."""
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ImportFrom) and node.module == 'scipy.optimize':
            if SOLVERS & {alias.name for alias in node.names}:
                return True
        elif isinstance(node, ast.Attribute) and node.attr in SOLVERS:
            return True
    return False


def test_one_module_holds_the_least_squares_step() -> None:
    package = ROOT / 'trawl_ros'
    found = {str(path.relative_to(package)) for path in package.rglob('*.py') if _steps(path)}
    assert found == STEPS


def test_another_step_is_noticed(tmp_path: Path) -> None:
    for line in (
        'from scipy.optimize import lsq_linear',
        'import scipy.optimize\nscipy.optimize.least_squares(f, x)',
    ):
        path = tmp_path / 'module.py'
        path.write_text(line, encoding='utf-8')
        assert _steps(path)


def test_the_drawn_imports_between_folders_have_no_cycle() -> None:
    graph = grimp.build_graph('trawl_ros', cache_dir=None)
    packages = {module for module in graph.modules if graph.find_children(module)}
    folders = {module: module.rpartition('.')[0] for module in graph.modules - packages}
    arrows: dict[str, set[str]] = {}
    for module, folder in folders.items():
        wanted = {folders[m] for m in graph.find_modules_directly_imported_by(module) - packages}
        arrows.setdefault(folder, set()).update(wanted - {folder})
    # It raises a CycleError that names the folders.
    assert len(list(TopologicalSorter(arrows).static_order())) > 40


def test_the_document_is_drawn_from_the_contract() -> None:
    text = LAYERS['DESIGN'].read_text(encoding='utf-8')
    assert text == LAYERS['drawn'](text), 'python test/layers.py draws it anew'


def test_no_folder_is_a_long_corridor() -> None:
    for folder in (path.parent for path in (ROOT / 'trawl_ros').rglob('__init__.py')):
        assert len(list(folder.glob('*.py'))) - 1 <= MOST, folder
        assert LAYERS['sentence'](folder), folder
