"""SQLite files that bring names which are none, columns that are computed, or tables that run."""

import sqlite3
from contextlib import closing

import pytest

from trawl_ros.bags.reader import Bag
from trawl_ros.core.errors import BagError

TABLES = (
    'CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format, '
    'offered_qos_profiles)',
    'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)',
)
TOPIC = "INSERT INTO topics VALUES(1, '/a', 'std_msgs/msg/Empty', 'cdr', '')"
MESSAGE = "INSERT INTO messages VALUES(1, 1, 5, x'0001000000')"


def database(path, *lines):
    with closing(sqlite3.connect(path)) as file:
        for line in lines:
            file.execute(line)
        file.commit()
    return path


@pytest.mark.parametrize(
    'row',
    [
        "(2, NULL, 'std_msgs/msg/Empty', 'cdr', '')",
        "(2, x'ff00', 'std_msgs/msg/Empty', 'cdr', '')",
        "(2, '/b', NULL, 'cdr', '')",
        "(2, '/b', x'80', 'cdr', '')",
        "(2, '/b', 'std_msgs/msg/Empty', 7, '')",
        "(2, '/b', 'std_msgs/msg/Empty', 'cdr', x'80')",
        "('x', '/b', 'std_msgs/msg/Empty', 'cdr', '')",
    ],
)
def test_a_topic_that_is_not_described_in_text_is_said_and_the_others_are_read(tmp_path, row):
    tables = (TABLES[0].replace('INTEGER PRIMARY KEY', ''), TABLES[1])
    path = database(tmp_path / 'a.db3', *tables, TOPIC, f'INSERT INTO topics VALUES{row}', MESSAGE)
    bag = Bag(path, lenient=True)
    assert [message.topic for message in bag.messages()] == ['/a']
    assert any('topic' in problem or '/b' in problem for problem in bag.problems) or 'x' in row


@pytest.mark.parametrize(
    ('lines', 'words'),
    [
        (
            (
                TABLES[0],
                'CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, '
                'data AS (zeroblob(900000000)))',
            ),
            'plain columns data',
        ),
        (
            (TABLES[0], 'CREATE VIEW messages AS SELECT 1 id, 1 topic_id, 1 timestamp, 1 data'),
            'without table messages',
        ),
        (
            (TABLES[0], 'CREATE VIRTUAL TABLE messages USING fts5(id, topic_id, timestamp, data)'),
            'without table messages',
        ),
        ((TABLES[1], 'CREATE TABLE topics(id, name)'), 'serialization_format, type'),
    ],
)
def test_what_is_no_plain_table_is_not_read(tmp_path, lines, words):
    with pytest.raises(BagError, match=words):
        Bag(database(tmp_path / 'a.db3', *lines))


def test_more_messages_than_the_file_can_hold_are_refused(tmp_path):
    """Pages that are shared, here by a tree whose leaves are all the same page."""
    fill = (
        'WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 400) '
        'INSERT INTO messages SELECT i, 1, i, zeroblob(1000) FROM n'
    )
    path = database(tmp_path / 'a.db3', *TABLES, TOPIC, fill)
    with closing(sqlite3.connect(path)) as file:
        (root,) = file.execute(
            "SELECT rootpage FROM sqlite_master WHERE name='messages'"
        ).fetchone()
        (size,) = file.execute('PRAGMA page_size').fetchone()
    data = bytearray(path.read_bytes())
    page = memoryview(data)[(root - 1) * size : root * size]
    # All children of the root, twice: the second half of the cells point to the first child.
    cells = int.from_bytes(page[3:5], 'big')
    for number in range(cells):
        cell = int.from_bytes(page[12 + 2 * number : 14 + 2 * number], 'big')
        page[cell : cell + 4] = root.to_bytes(4, 'big') if number % 2 else page[cell : cell + 4]
    path.write_bytes(data)
    bag = None
    try:
        bag = Bag(path, lenient=True)
        count = sum(1 for _ in bag.as_stored())
    except BagError:
        return
    assert count <= 400
    assert bag.problems
