"""Compiled loops find a folder, and a long first start says why it is one."""

import logging
import os
import re
import threading
from pathlib import Path

import pytest

from trawl_ros.core import first_start
from trawl_ros.core.first_start import CompilationWatch, LoopFolder, loop_folder, need_home


@pytest.fixture
def places(tmp_path, monkeypatch):
    """Package, home and temporary folder below one folder; a working folder beside them."""
    for name in ('package', 'home', 'temporary', 'work'):
        (tmp_path / name).mkdir()
    monkeypatch.setattr(first_start, 'PACKAGE', tmp_path / 'package')
    monkeypatch.setattr(first_start.tempfile, 'tempdir', str(tmp_path / 'temporary'))
    monkeypatch.chdir(tmp_path / 'work')
    return tmp_path


@pytest.fixture
def closed(monkeypatch):
    """Close folders to writing, for root too."""
    shut: set[Path] = set()
    takes = first_start._takes_files
    within = lambda path: not shut.isdisjoint((Path(path), *Path(path).parents))  # noqa: E731
    monkeypatch.setattr(first_start, '_takes_files', lambda path: not within(path) and takes(path))
    return shut


def test_folders_are_tried_in_their_order(places, closed):
    environment = {'HOME': str(places / 'home'), 'NUMBA_CACHE_DIR': str(places / 'given')}
    private = places / 'temporary' / f'trawl_ros-{os.getuid()}'
    expected = [
        places / 'given',
        places / 'package' / '__pycache__' / 'loops',
        places / 'home' / '.cache' / 'trawl_ros',
        private,
        None,
    ]
    for path in expected:
        found = loop_folder(environment)
        assert found.path == path
        assert ('NUMBA_CACHE_DIR=' in found.why) == (path != places / 'given')
        closed.add(path)
        if path == private:
            assert str(path) in found.why
    assert 'at each start' in loop_folder(environment).why
    assert list((places / 'work').iterdir()) == []


@pytest.mark.parametrize('environment', [{}, {'HOME': ''}, {'HOME': '~'}, {'HOME': '/nowhere'}])
def test_without_a_home_the_temporary_folder_is_used(places, closed, environment):
    closed.add(places / 'package')
    assert loop_folder(environment).path == places / 'temporary' / f'trawl_ros-{os.getuid()}'
    assert list((places / 'work').iterdir()) == []


@pytest.mark.parametrize('mode', [0o777, 0o720])
def test_a_temporary_folder_that_others_can_write_to_is_not_used(places, closed, mode):
    closed.add(places / 'package')
    folder = places / 'temporary' / f'trawl_ros-{os.getuid()}'
    folder.mkdir()
    folder.chmod(mode)
    assert loop_folder({}).path is None


def test_a_link_in_place_of_the_temporary_folder_is_not_used(places, closed):
    closed.add(places / 'package')
    (places / 'temporary' / f'trawl_ros-{os.getuid()}').symlink_to(places / 'work')
    assert loop_folder({}).path is None


def test_the_working_folder_is_no_temporary_one(places, closed, monkeypatch):
    closed.add(places / 'package')
    monkeypatch.setattr(first_start.tempfile, 'tempdir', str(places / 'work'))
    assert loop_folder({}).path is None
    assert list((places / 'work').iterdir()) == []


def test_a_process_without_a_home_gets_one_that_does_not_count_as_such(places, closed, monkeypatch):
    closed.add(places / 'package')
    monkeypatch.setenv('HOME', '/nowhere')
    need_home()
    assert Path(os.environ['HOME']).parent == places / 'temporary'
    assert 'until' in loop_folder(os.environ).why
    monkeypatch.setenv('HOME', str(places / 'home'))
    need_home()
    assert os.environ['HOME'] == str(places / 'home')


def test_a_long_compilation_says_why_and_how_far_it_is(caplog):
    now = 0.0
    watch = CompilationWatch(lambda: now)
    watch.folder = LoopFolder(None, 'at each start')
    with caplog.at_level(logging.WARNING):
        for _ in range(13):
            watch.begin()
            for _ in range(10):
                watch.step()
                now += 0.1
            watch.end()
            now += 100.0
    first, *others = [record.getMessage() for record in caplog.records]
    assert 'at each start' in first
    assert len(others) == 2
    assert re.findall(r'\d+', others[-1]) == ['11', '11']


def test_a_short_compilation_says_nothing(caplog):
    watch = CompilationWatch(lambda: 0.0)
    for _ in range(10):
        watch.begin()
        watch.step()
        watch.end()
    assert not caplog.records


def test_a_wish_to_stop_ends_a_compilation_of_the_main_thread():
    watch = CompilationWatch()
    with watch.stopping(lambda: True):
        watch.begin()
        thread = threading.Thread(target=watch.step)
        thread.start()
        thread.join()
        with pytest.raises(KeyboardInterrupt):
            watch.step()
    watch.step()
