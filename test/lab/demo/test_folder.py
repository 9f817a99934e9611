"""A demo replaces what a former demo left, and nothing else."""

import json

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.lab.demo.folder import DemoFolder


def content(folder):
    return json.loads((folder / 'summary.json').read_text())


def test_a_new_folder_is_marked_before_anything_is_done(tmp_path):
    folder = DemoFolder(tmp_path / 'out' / 'demo')
    assert content(folder.path) == {'made_by': 'trawl demo', 'finished': False}


def test_a_former_demo_is_replaced_and_what_others_put_there_stays(tmp_path):
    folder = DemoFolder(tmp_path)
    folder.bag.mkdir()
    (folder.bag / 'bag_0.mcap').write_bytes(b'old')
    (tmp_path / 'identification.json').write_text('{}')
    (tmp_path / 'history.png').write_bytes(b'old')
    (tmp_path / 'report.html').write_text('old')
    (tmp_path / 'notes.txt').write_text('mine')
    DemoFolder(tmp_path)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ['notes.txt', 'summary.json']


@pytest.mark.parametrize('summary', [None, '{"made_by": "me"}', 'not JSON', '[]'])
def test_a_folder_that_no_demo_has_made_is_refused_and_left_as_it_is(tmp_path, summary):
    (tmp_path / 'bag').mkdir()
    (tmp_path / 'bag' / 'mine').write_text('mine')
    if summary is not None:
        (tmp_path / 'summary.json').write_text(summary)
    with pytest.raises(TrawlError, match='holds files that `trawl demo` has not written'):
        DemoFolder(tmp_path)
    assert (tmp_path / 'bag' / 'mine').read_text() == 'mine'


def test_the_report_of_the_node_moves_up(tmp_path):
    folder = DemoFolder(tmp_path)
    folder.results.mkdir()
    (folder.results / 'identification.json').write_text('{}')
    (folder.results / 'channels.png').write_bytes(b'')
    assert folder.gather_results() == ['channels.png', 'identification.json']
    assert (tmp_path / 'identification.json').is_file()
    assert not folder.results.exists()


def test_a_place_that_cannot_be_used_is_said(tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(TrawlError, match='cannot be used'):
        DemoFolder(tmp_path / 'file' / 'demo')
