"""The log book keeps who was told what and when, whatever happens to the node."""

import json
import os
import re
from pathlib import Path

import pytest

from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.onset import log_book
from trawl_ros.diagnosis.onset.findings import Finding, OnsetValue
from trawl_ros.diagnosis.onset.log_book import LogBook

FINDING = Finding(
    3, 'raised', 600 * 10**9, 600 * 10**9, 540 * 10**9, 510 * 10**9, 570 * 10**9, 'kite',
    'The kite is lost', {'lost': OnsetValue(0.4, 0.3, 0.5, '')}, ('net_depth_offset',), 12.0, 8.0,
)  # fmt: skip


def test_an_event_has_its_time_its_finding_and_who_was_told(tmp_path):
    book = LogBook(tmp_path / 'book.jsonl')
    book.write('published', 600 * 10**9, 'discrepancy_node', FINDING, to=['bridge'])
    (event,) = book.events()
    assert (event['event'], event['who'], event['to']) == (
        'published',
        'discrepancy_node',
        ['bridge'],
    )
    assert re.search(r'kite .* 1\.0 min ', event['sentence'])
    assert book.last_number() == 3


def test_a_line_that_a_kill_cut_short_is_taken_off_and_the_rest_stays(tmp_path):
    path = tmp_path / 'book.jsonl'
    LogBook(path).write('raised', 0, 'discrepancy_node', FINDING)
    with path.open('a') as file:
        file.write('{"time": "2026", "event": "ackno')
    book = LogBook(path)
    book.write('acknowledged', 1, 'operator', FINDING)
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [line['event'] for line in lines] == ['raised', 'acknowledged']


def test_a_book_that_is_full_is_set_aside_once(tmp_path, monkeypatch):
    monkeypatch.setattr(log_book, 'MOST_BYTES', 1000)
    book = LogBook(tmp_path / 'book.jsonl')
    for stamp in range(40):
        book.write('raised', stamp, 'discrepancy_node', FINDING)
    assert sum(path.stat().st_size for path in tmp_path.iterdir()) < 4000
    stamps = [event['stamp_ns'] for event in book.events()]
    assert stamps == list(range(stamps[0], 40))


def test_a_link_in_place_of_the_book_is_refused(tmp_path):
    (tmp_path / 'elsewhere').touch()
    path = tmp_path / 'book.jsonl'
    path.symlink_to(tmp_path / 'elsewhere')
    with pytest.raises(TrawlError, match='expected a file'):
        LogBook(path)


OWN = b'{"time": "2026", "event": "begun", "stamp_ns": 0, "who": "discrepancy_node"}\n'


@pytest.mark.parametrize(
    'content',
    [
        b'notes of the day',
        b'notes of the day\nand of the next',
        b'{"depth": 61.5}\n{"depth": 61',
        b'\x00' * 100,
        b'\n',
        OWN + b'notes of the day',
        b'{"time": "2026", "event": "begun"}\n',
    ],
)
@pytest.mark.parametrize('name', ['book', 'book.1'])
def test_a_foreign_file_is_refused_and_stays(tmp_path, content, name):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(TrawlError, match=f'{path}: '):
        LogBook(tmp_path / 'book')
    assert path.read_bytes() == content
    assert [file.name for file in tmp_path.iterdir()] == [name]


def test_a_foreign_file_that_comes_later_is_not_replaced(tmp_path, monkeypatch):
    monkeypatch.setattr(log_book, 'MOST_BYTES', 1000)
    book = LogBook(tmp_path / 'book')
    (tmp_path / 'book.1').write_text('mine')
    with pytest.raises(TrawlError, match=r'book\.1: '):  # noqa: PT012
        for stamp in range(40):
            book.write('raised', stamp, 'discrepancy_node', FINDING)
    assert (tmp_path / 'book.1').read_text() == 'mine'


def test_pipes_and_devices_are_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / 'pipe')
    for path in (tmp_path / 'pipe', Path('/dev/zero'), tmp_path):
        with pytest.raises(TrawlError, match='expected a file'):
            LogBook(path)


def test_many_listeners_do_not_break_a_line(tmp_path):
    book = LogBook(tmp_path / 'book')
    book.write('published', 0, 'discrepancy_node', FINDING, to=['n' * 255] * 1000)
    assert LogBook(tmp_path / 'book').last_number() == 3
    assert len(book.events()) == 1


@pytest.mark.parametrize('cut', range(1, len(OWN)))
def test_a_first_line_that_was_cut_anywhere_is_removed(tmp_path, cut):
    (tmp_path / 'book').write_bytes(OWN[:cut])
    LogBook(tmp_path / 'book').write('begun', 0, 'discrepancy_node')
    assert len((tmp_path / 'book').read_text().splitlines()) == 1
