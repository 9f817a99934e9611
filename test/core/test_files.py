"""Results are written whole, and never through a link."""

import errno
import json
from pathlib import Path

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending, write_json, write_text, written


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
            raise OSError(errno.ENOSPC, 'No space left on device')

    with pytest.raises(
        TrawlError, match=r'page.html: cannot be written \(No space left on device\)'
    ):
        fail()
    assert path.read_text() == 'old'
    assert [file.name for file in tmp_path.iterdir()] == ['page.html']


def test_a_log_is_not_added_to_through_a_link(tmp_path: Path) -> None:
    (tmp_path / 'victim').write_text('mine')
    (tmp_path / 'log').symlink_to('victim')
    with pytest.raises(TrawlError, match='cannot be written'):
        appending(tmp_path / 'log')
    with appending(tmp_path / 'other') as log:
        log.write('a\n')
    with appending(tmp_path / 'other') as log:
        log.write('b\n')
    assert (tmp_path / 'other').read_text() == 'a\nb\n'


def test_names_that_are_no_text_do_not_stop_a_report(tmp_path: Path) -> None:
    write_text(tmp_path / 'page', 'tow \udcff')
    assert (tmp_path / 'page').read_text() == 'tow \\udcff\n'
