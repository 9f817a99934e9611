"""What is interrupted, or does not fit its disk, leaves nothing that looks whole."""

import pytest

from trawl_ros.bags.export import export_bag
from trawl_ros.bags.logs.import_log import import_log
from trawl_ros.bags.repair import repair_bag
from trawl_ros.bags.sentence_log import write_sentence_log
from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError
from trawl_ros.core.files import written_folder
from trawl_ros.records.fields import WaterColumn
from trawl_ros.sentences.table import load_tables

TOO_LONG = 'x' * 252
"""Fits a folder, but not the files in it."""


def interrupt_after(count):
    left = iter(range(count))

    def interrupt(*_):
        if next(left, None) is None:
            raise KeyboardInterrupt

    return interrupt


def state(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob('*'))


@pytest.mark.parametrize('count', [0, 1, 300])
def test_an_interrupted_export_leaves_no_table(sound_bag, tmp_path, count):
    with pytest.raises(KeyboardInterrupt):
        export_bag(sound_bag, tmp_path / 'tables', on_progress=interrupt_after(count))
    assert state(tmp_path) == []
    done = export_bag(sound_bag, tmp_path / 'tables')
    assert all(table.file.is_file() for table in done.topics)
    assert state(tmp_path)[0] == 'tables'


def test_an_interrupted_repair_leaves_no_bag(bag_path, tmp_path):
    (bag_path / 'metadata.yaml').unlink()
    with pytest.raises(KeyboardInterrupt):
        repair_bag(bag_path, tmp_path / 'new', on_progress=interrupt_after(10))
    assert state(tmp_path) == ['trial', 'trial/trial_0.mcap']


def test_an_interrupted_log_of_sentences_leaves_none(sound_bag, tmp_path, monkeypatch):
    stop = interrupt_after(20)
    monkeypatch.setattr('trawl_ros.bags.sentence_log._told_by', stop)
    water = WaterColumn(density_kg_m3=1025.0)
    with pytest.raises(KeyboardInterrupt):
        write_sentence_log(sound_bag, load_tables(['scantrol']), tmp_path / 'log', water=water)
    assert state(tmp_path) == []


def test_names_that_are_too_long_leave_nothing(sound_bag, tmp_path):
    log, mapping = tmp_path / 'log.csv', tmp_path / 'log.yaml'
    log.write_text('s,depth\n0,61.5\n')
    mapping.write_text(
        "clock: {columns: [s], format: elapsed seconds, start: '2026-08-01 12:00:00'}\n"
        'water: {density_kg_m3: 1025.0}\n'
        'topics: {door/port/pressure: {fields: {depth: {column: depth, unit: m}}}}\n'
    )
    out = tmp_path / 'out' / TOO_LONG
    (tmp_path / 'out').mkdir()
    for act in (
        lambda: BagWriter(out),
        lambda: import_log(log, mapping, out),
        lambda: repair_bag(sound_bag / 'trial_0.mcap', out),
    ):
        with pytest.raises(BagError, match=f'^{out}: cannot be written'):
            act()
        assert state(tmp_path / 'out') == []


def test_an_error_names_the_folder_that_was_wanted(tmp_path):
    def write():
        with written_folder(tmp_path / 'bag', BagError) as draft:
            draft.mkdir()
            raise BagError(f'{draft}: full')

    with pytest.raises(BagError, match=f'^{tmp_path / "bag"}: full$'):
        write()
    assert state(tmp_path) == []
