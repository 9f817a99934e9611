"""The data that come with the package are found wherever the package lies."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import trawl_ros
from trawl_ros.bags.logs.mapping import load_mapping
from trawl_ros.core.errors import GearError, InstrumentError, LogError, ScenarioError, TrawlError
from trawl_ros.core.resources import bag_name, packaged_bag, share_path
from trawl_ros.gear.load import load_gear
from trawl_ros.instruments.parameters import load_instruments
from trawl_ros.scenario.scenario import load_scenario

SOURCE = Path(trawl_ros.__file__).parent
ASK = 'from trawl_ros.core.resources import share_path; print(share_path("config", "a.yaml"))'


def ask(python_path: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Ask the copy of the package in `python_path` for its file config/a.yaml."""
    inherited = {key: value for key, value in os.environ.items() if key != 'AMENT_PREFIX_PATH'}
    return subprocess.run(
        [sys.executable, '-c', ASK],
        env={**inherited, 'PYTHONPATH': str(python_path), **environment},
        cwd=python_path,
        capture_output=True,
        text=True,
        check=False,
    )


def put_module(folder: Path) -> Path:
    """Copy what the look-up consists of into a folder for PYTHONPATH."""
    package = folder / 'trawl_ros'
    package.mkdir(parents=True)
    (package / '__init__.py').touch()
    (package / 'core').mkdir()
    for name in ('__init__.py', 'errors.py', 'resources.py'):
        shutil.copy(SOURCE / 'core' / name, package / 'core')
    return folder


def put_data(share: Path) -> Path:
    """Make a share folder with one file in it and return that file."""
    file = share / 'config' / 'a.yaml'
    file.parent.mkdir(parents=True)
    file.touch()
    (share / 'package.xml').touch()
    return file


def put_marker(prefix: Path) -> None:
    marker = prefix / 'share/ament_index/resource_index/packages/trawl_ros'
    marker.parent.mkdir(parents=True)
    marker.touch()


def test_this_copy_of_the_package_has_its_data():
    assert share_path('config').is_dir()
    assert share_path('package.xml').is_file()


def test_a_checkout_has_them_beside_the_package(tmp_path):
    data = put_data(tmp_path / 'checkout')
    assert ask(put_module(tmp_path / 'checkout')).stdout.strip() == str(data)


@pytest.mark.parametrize(
    'site', ['lib/python3.12/site-packages', 'local/lib/python3.12/dist-packages']
)
def test_an_installed_package_has_them_in_its_own_prefix(tmp_path, site):
    data = put_data(tmp_path / 'install/share/trawl_ros')
    assert ask(put_module(tmp_path / 'install' / site)).stdout.strip() == str(data)


def test_another_workspace_in_the_ament_index_does_not_replace_them(tmp_path):
    own = put_data(tmp_path / 'own/share/trawl_ros')
    put_data(tmp_path / 'other/share/trawl_ros')
    put_marker(tmp_path / 'other')
    module = put_module(tmp_path / 'own/lib/python3.12/site-packages')
    assert ask(module, AMENT_PREFIX_PATH=str(tmp_path / 'other')).stdout.strip() == str(own)


def test_the_ament_index_tells_where_they_are_when_python_lies_elsewhere(tmp_path):
    pytest.importorskip('ament_index_python')
    data = put_data(tmp_path / 'data/share/trawl_ros')
    put_marker(tmp_path / 'data')
    module = put_module(tmp_path / 'python')
    assert ask(module, AMENT_PREFIX_PATH=str(tmp_path / 'data')).stdout.strip() == str(data)


def test_no_data_at_all_is_said_in_one_sentence(tmp_path):
    answer = ask(put_module(tmp_path / 'python'))
    assert answer.returncode != 0
    last = answer.stderr.strip().splitlines()[-1]
    assert 'TrawlError' in last
    assert 'share/trawl_ros' in last


def test_an_unknown_name_is_answered_with_the_known_ones():
    with pytest.raises(TrawlError, match=r'gaer.*\bgear\b'):
        share_path('config', 'gaer')


@pytest.mark.parametrize(
    ('load', 'known', 'error'),
    [
        (load_gear, 'kaifuha', GearError),
        (load_scenario, 'shakedown', ScenarioError),
        (load_instruments, 'default', InstrumentError),
        (load_mapping, 'door_test_haul_log', LogError),
    ],
)
def test_files_of_the_package_are_named_alike(load, known, error, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    load(known)
    with pytest.raises(error, match=rf'^nonesuch: .*\b{known}\b'):
        load('nonesuch')


@pytest.mark.parametrize('name', ['shakedwn', 'shake_down', 'demoo'])
def test_a_name_that_is_nearly_one_of_them_is_answered_with_that_one(name):
    known = 'demo' if name.startswith('demo') else 'shakedown'
    with pytest.raises(ScenarioError, match=rf'\b{known}\b'):
        load_scenario(name)


def test_a_sample_bag_is_spoken_of_by_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert bag_name(packaged_bag('sea_trial')) == 'sea_trial'
    assert bag_name(tmp_path / 'sea_trial') == str(tmp_path / 'sea_trial')
