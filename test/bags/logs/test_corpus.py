"""Logs that failed once give the right readings, or what is lost is counted and told."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.core.errors import LogError
from trawl_ros.sentences.framing import SentenceSplitter, Unreadable, parse_line

HERE = Path(__file__).parents[2] / 'corpus'
PACKAGED = (Path(__file__).parents[3] / 'config/logs/nmea.yaml').read_text()
MAPPINGS = {
    'as packaged': PACKAGED,
    'dated': PACKAGED.replace('  time: sentences', '  date: 2026-08-01\n  time: sentences'),
    'recorder': PACKAGED.replace('time: sentences', 'time: recorder\n  recorder: {format: iso}'),
}
CASES = yaml.safe_load((HERE / 'nmea.yaml').read_text())
FILES = sorted((HERE / 'nmea').iterdir())


@pytest.mark.parametrize('case', CASES, ids=lambda case: f'{case["file"]} {case["mapping"]}')
def test_a_log_that_failed_once_gives_what_it_holds(tmp_path, case):
    mapping = tmp_path / 'mapping.yaml'
    mapping.write_text(MAPPINGS[case['mapping']])
    log = HERE / 'nmea' / case['file']
    if 'error' in case:
        with pytest.raises(LogError) as raised:
            import_log(log, mapping, tmp_path / 'bag', leave_out=True)
        assert str(raised.value) == f'{log}: {case["error"]}'
        return
    done = import_log(log, mapping, tmp_path / 'bag', leave_out=True)
    counts = {topic.removeprefix('/trawl/'): count for topic, count in done.counts.items()}
    assert counts == case['messages']
    assert dict(done.left_out) == case.get('left_out', {})
    assert list(done.notes) == case.get('notes', [])


def test_each_file_of_the_corpus_is_run():
    assert {case['file'] for case in CASES} == {file.name for file in FILES}


def frames(pieces):
    found = []
    for piece in pieces:
        try:
            found.append(parse_line(piece).body)
        except Unreadable as reason:
            found.append(str(reason))
    return found


@pytest.mark.parametrize('file', FILES, ids=lambda file: file.name)
def test_a_stream_and_datagrams_are_framed_as_the_file_is(file):
    data = file.read_bytes()
    splitter = SentenceSplitter()
    whole = frames([*splitter.feed(data), *splitter.end()])
    draws = np.random.default_rng(5)
    stream, pieces, place = SentenceSplitter(), [], 0
    while place < len(data):
        step = int(draws.integers(1, 700))
        pieces += stream.feed(data[place : place + step])
        place += step
    assert frames([*pieces, *stream.end()]) == whole
    assert stream.too_long == splitter.too_long
    assert frames(SentenceSplitter().datagram(data)) == whole
