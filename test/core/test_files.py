"""Results are written whole, and never through a link."""

import errno
import json
import os
import re
import resource
from pathlib import Path

import pytest

from trawl_ros.core.errors import BagError, TrawlError
from trawl_ros.core.files import (
    appending,
    empty_folder,
    is_there,
    made_folder,
    new_folder,
    write_json,
    write_text,
    written,
)


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path: Path) -> None:
    victim, link = tmp_path / 'victim', tmp_path / 'out.json'
    victim.write_text('mine')
    link.symlink_to(victim)
    write_json(link, {'a': 1})
    assert victim.read_text() == 'mine'
    assert not link.is_symlink()
    assert json.loads(link.read_text()) == {'a': 1}


def test_a_link_planted_where_the_draft_goes_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / 'victim').write_text('mine')
    with written(tmp_path / 'page') as draft:
        pass_by = draft
        draft.write_text('x')
    pass_by.symlink_to(tmp_path / 'victim')
    write_text(tmp_path / 'page', 'new')
    assert (tmp_path / 'victim').read_text() == 'mine'
    assert (tmp_path / 'page').read_text() == 'new\n'


def test_what_fails_half_way_leaves_the_old_file_and_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / 'page.html'
    path.write_text('old')

    def fail() -> None:
        with written(path) as draft:
            draft.write_text('half')
            raise OSError(errno.ENOSPC, 'disk full')

    with pytest.raises(TrawlError, match=r'page\.html: .*disk full'):
        fail()
    assert path.read_text() == 'old'
    assert [file.name for file in tmp_path.iterdir()] == ['page.html']


def test_a_log_is_not_added_to_through_a_link(tmp_path: Path) -> None:
    (tmp_path / 'victim').write_text('mine')
    (tmp_path / 'log').symlink_to('victim')
    with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
        appending(tmp_path / 'log')
    with appending(tmp_path / 'other') as log:
        log.write('a\n')
    with appending(tmp_path / 'other') as log:
        log.write('b\n')
    assert (tmp_path / 'other').read_text() == 'a\nb\n'


def test_names_that_are_no_text_do_not_stop_a_report(tmp_path: Path) -> None:
    write_text(tmp_path / 'page', 'tow \udcff')
    assert (tmp_path / 'page').read_text() == 'tow \\udcff\n'


def test_the_check_of_a_folder_leaves_nothing_behind(tmp_path: Path) -> None:
    out = tmp_path / 'a' / 'b'
    assert empty_folder(out, force=False) == out
    assert new_folder(out, BagError) == out
    assert list(tmp_path.iterdir()) == []
    made_folder(out)
    empty_folder(out, force=False)
    assert list(out.iterdir()) == []
    (out / 'mine').write_text('mine')
    with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
        empty_folder(out, force=False)
    assert empty_folder(out, force=True) == out
    with pytest.raises(BagError, match=re.escape(str(tmp_path))):
        new_folder(out, BagError)


def test_a_link_to_nowhere_is_no_new_folder(tmp_path: Path) -> None:
    (tmp_path / 'link').symlink_to(tmp_path / 'gone')
    with pytest.raises(BagError, match=re.escape(str(tmp_path))):
        new_folder(tmp_path / 'link', BagError)
    with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
        empty_folder(tmp_path / 'link' / 'out', force=True)


@pytest.mark.parametrize('name', ['file/out', 'x' * 300])
def test_a_place_that_takes_no_folder_is_told(name: str, tmp_path: Path) -> None:
    (tmp_path / 'file').write_text('mine')
    with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
        empty_folder(tmp_path / name, force=True)
    with pytest.raises(BagError, match=re.escape(str(tmp_path))):
        new_folder(tmp_path / name, BagError)
    with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
        made_folder(tmp_path / name)


def test_a_full_disk_is_told_before_the_work(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        with pytest.raises(TrawlError, match=re.escape(str(tmp_path))):
            empty_folder(tmp_path, force=False)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert list(tmp_path.iterdir()) == []


def test_what_is_continued_is_a_file_or_new(tmp_path: Path) -> None:
    (tmp_path / 'file').touch()
    assert is_there(tmp_path / 'file', TrawlError)
    assert not is_there(tmp_path / 'new', TrawlError)
    (tmp_path / 'link').symlink_to('nowhere')
    os.mkfifo(tmp_path / 'pipe')
    for path in (tmp_path, tmp_path / 'link', tmp_path / 'pipe', Path('/dev/null')):
        with pytest.raises(TrawlError, match=re.escape(str(path))):
            is_there(path, TrawlError)
