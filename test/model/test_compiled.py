"""Compiled loops are kept, and no file in their folder stands in the way of a start."""

import errno

import numpy as np
import pytest
from numba.core.caching import IndexDataCacheFile

from trawl_ros.core.first_start import LoopFolder
from trawl_ros.model import compiled as module


def add_one(values):
    for place in range(len(values)):
        values[place] += 1.0


@pytest.fixture
def started(tmp_path, monkeypatch):
    """Compile a loop as a new process would; return how often it came out of the folder."""

    def start(folder=tmp_path):
        monkeypatch.setattr(module, 'FOLDER', LoopFolder(folder, ''))
        loop = module.compiled(add_one)
        values = np.zeros(3)
        loop(values)
        assert values.tolist() == [1.0] * 3
        return sum(loop.stats.cache_hits.values())

    return start


def files_of(folder):
    return [path for path in folder.rglob('*') if path.is_file()]


def test_a_loop_is_compiled_once(started, tmp_path):
    assert [started(), started()] == [0, 1]
    assert {path.suffix for path in files_of(tmp_path)} == {'.nbi', '.nbc'}


@pytest.mark.parametrize('suffix', ['.nbi', '.nbc'])
@pytest.mark.parametrize('content', [b'', b'half', b'\x80\x05]', bytes(5000)])
def test_a_file_that_a_power_cut_damaged_is_replaced(started, tmp_path, suffix, content):
    started()
    for path in files_of(tmp_path):
        if path.suffix == suffix:
            path.write_bytes(content)
    assert [started(), started()] == [0, 1]


@pytest.mark.parametrize('number', [errno.ENOSPC, errno.EROFS, errno.EDQUOT])
def test_a_folder_that_takes_no_more_is_no_error(started, tmp_path, monkeypatch, number):
    def refuse(self, path):
        raise OSError(number, 'refused')

    monkeypatch.setattr(IndexDataCacheFile, '_open_for_write', refuse)
    assert [started(), started()] == [0, 0]
    assert files_of(tmp_path) == []


def test_without_a_folder_it_is_compiled_each_time(started):
    assert [started(None), started(None)] == [0, 0]
