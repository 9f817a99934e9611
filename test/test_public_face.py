"""The names at the root of the package."""

import ast
import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import trawl_ros

ROOT = Path(trawl_ros.__file__).parents[1]

TOW = """
description: Six seconds of a steady tow
gear: coarse.yaml
start: {warp_length_m: 300.0, speed_m_s: 2.3}
steps: [{name: steady, minutes: 0.1}]
truth_rate_hz: 2.0
"""


def test_it_is_some_forty_names_each_with_a_docstring():
    assert 25 <= len(trawl_ros.__all__) <= 45
    assert trawl_ros.__all__ == sorted(trawl_ros.__all__)
    for name in trawl_ros.__all__:
        assert inspect.getdoc(getattr(trawl_ros, name)), name


def test_what_is_loaded_late_is_what_type_checkers_are_told():
    tree = ast.parse(Path(trawl_ros.__file__).read_text())
    branch = next(node for node in tree.body if isinstance(node, ast.If))
    told = {
        alias.name: statement.module
        for statement in branch.body
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
    }
    assert told == trawl_ros._HOMES
    assert sorted(told) == trawl_ros.__all__


def test_a_name_that_there_is_not_is_told_as_python_tells_it():
    with pytest.raises(AttributeError, match="'trawl_ros' has no attribute 'haul'"):
        _ = trawl_ros.haul
    assert 'tow' in dir(trawl_ros)


def test_the_package_alone_imports_nothing_heavy():
    code = 'import sys, trawl_ros; print(sorted({"numpy", "numba", "scipy"} & set(sys.modules)))'
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == '[]'


def test_functions_name_parameters_and_errors():
    for name in trawl_ros.__all__:
        found = getattr(trawl_ros, name)
        if inspect.isfunction(found):
            text = inspect.getdoc(found)
            for parameter in inspect.signature(found).parameters:
                assert parameter in text, f'{name}: {parameter}'
            for section in ('Raises', 'Examples'):
                assert f'{section}\n---' in text, f'{name}: {section}'
            assert re.search('(Returns|Yields)\n---', text), name


@pytest.fixture(scope='module')
def folder(tmp_path_factory, steady_tow, coarse_gear):
    """A folder like a checkout, with the coarse gear and a bag of two steady states of it."""
    folder = tmp_path_factory.mktemp('examples')
    for name in ('bags', 'config'):
        (folder / name).symlink_to(ROOT / name)
    (folder / 'coarse.yaml').symlink_to(coarse_gear)
    (folder / 'tow.yaml').write_text(TOW)
    steady_tow.bag(folder / 'tow_1')
    return folder


@pytest.mark.parametrize('name', trawl_ros.__all__)
def test_examples_hold(name, folder, monkeypatch):
    monkeypatch.chdir(folder)
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(trawl_ros, name), name, globs={})
    assert example.examples, f'{name} has no example'
    report = []
    doctest.DocTestRunner().run(example, out=report.append)
    assert not report, ''.join(report)


def test_what_runs_on_a_ship_imports_no_lab():
    code = (
        'import sys, trawl_ros.api.tows, trawl_ros.api.trials, trawl_ros.cli.tow; '
        'print([name for name in sys.modules if name.startswith("trawl_ros.lab")])'
    )
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == '[]'
