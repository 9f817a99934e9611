"""The log book keeps who was told what and when, whatever happens to the node."""

import json

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
    assert 'kite has begun 1.0 min ago' in event['sentence']
    assert book.last_number() == 3


def test_a_line_that_a_kill_cut_short_is_taken_off_and_the_rest_stays(tmp_path):
    path = tmp_path / 'book.jsonl'
    LogBook(path).write('raised', 0, 'discrepancy_node', FINDING)
    with path.open('a') as file:
        file.write('{"event": "ackno')
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
    with pytest.raises(TrawlError, match='cannot be written'):
        LogBook(path)
