# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""SQLite file of rosbag2: the default storage from Foxy to Humble, and optional in later ones.

A database is read without its ``metadata.yaml``; another module compares the two.
"""

import sqlite3
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote

from trawl_ros.bags.storage.qos import dump_profiles, parse_profiles
from trawl_ros.bags.storage.stored import Definition, RawMessage
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import one_line, open_file
from trawl_ros.core.limits import BAG_OPERATIONS, CHUNK_BYTES

_TABLES = {
    'messages': {'id', 'topic_id', 'timestamp', 'data'},
    'topics': {'id', 'name', 'type', 'serialization_format'},
}
"""Required tables with their columns."""

_DEFINITIONS = ('topic_type', 'encoding', 'encoded_message_definition')

_ALLOWED = (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ, sqlite3.SQLITE_PRAGMA)
_FUNCTIONS = ('length', 'count', 'total')
_STEPS = 10_000
"""Number of SQLite steps between two checks of the limit."""

_READ = 'SELECT topic_id, timestamp, data FROM messages WHERE length(data) <= ? ORDER BY '


class Database:
    """SQLite file of a bag, opened for reading.

    Parameters
    ----------
    path
        The file.
    report
        Takes a sentence for each thing that is wrong but can be lived with.

    Raises
    ------
    BagError
        If there is no file, or it is not a database of rosbag2.
    """

    storage = 'sqlite3'

    def __init__(self, path: Path, report: Callable[[str], None]) -> None:
        self.path = path
        self.chunk_compressions: set[str] = set()
        self.damaged_chunks = 0
        self.distro = ''
        self._report = report
        self._size = path.stat().st_size + sum(
            log.stat().st_size for log in [path.with_name(f'{path.name}-wal')] if log.is_file()
        )
        # Where a damaged page keeps it from being seen how much there is, nothing is sorted.
        self._order = 'id'
        self._topics: dict[int, tuple[str, str]] = {}
        self._definitions: dict[str, Definition] = {}
        try:
            with closing(self._connect()) as database:
                self._learn(database)
        except (sqlite3.Error, UnicodeDecodeError) as reason:
            raise BagError(f'{path}: cannot be read ({reason}); expected an SQLite bag') from reason

    @property
    def indexed(self) -> bool:
        """True: messages are always found by the database's index."""
        return True

    @property
    def definitions(self) -> dict[str, Definition]:
        """Definition of each topic's messages."""
        return dict(self._definitions)

    def types(self) -> set[tuple[str, str]]:
        """Return all pairs (topic, type)."""
        return set(self._topics.values())

    def counts(self) -> dict[tuple[str, str], int] | None:
        """Count the messages by (topic, type); None if the database refuses."""
        try:
            with closing(self._connect()) as database:
                rows = database.execute('SELECT topic_id, count(*) FROM messages GROUP BY topic_id')
                counts: Counter[tuple[str, str]] = Counter()
                for number, count in rows:
                    if number in self._topics:
                        counts[self._topics[number]] += count
                return dict(counts)
        except sqlite3.Error:
            return None

    def messages(self) -> Iterator[RawMessage]:
        """Yield all messages in the order of their times, as far as the database can be read."""
        lost: Counter[str] = Counter()
        read = size = 0
        try:
            with closing(self._connect()) as database:
                rows = database.execute(_READ + self._order, (CHUNK_BYTES.value,))
                for number, stamp, data in rows:
                    read += 1
                    size += len(data) if isinstance(data, bytes) else 0
                    self._check_size(size)
                    if number not in self._topics:
                        lost[f'of topic {number}, whose description is missing'] += 1
                    elif not isinstance(stamp, int) or not isinstance(data, bytes):
                        lost['that are not bytes with a time'] += 1
                    else:
                        topic, type_name = self._topics[number]
                        yield RawMessage(topic, type_name, stamp, stamp, data, number)
                (there,) = database.execute('SELECT count(*) FROM messages').fetchone()
                if there > read:
                    lost[f'of more than {CHUNK_BYTES.value} bytes'] += there - read
        except sqlite3.Error as reason:
            self._report(
                f'{self.path}: damaged behind {read} messages ({reason}); what stands before is '
                'used'
            )
        for which, count in lost.items():
            self._report(f'{self.path}: {count} messages {which} were left out')

    def _connect(self) -> sqlite3.Connection:
        open_file(self.path, BagError).close()
        # A recorder that was killed leaves its last messages in a log next to the database, which
        # is only looked at when the file is not said to be immutable.
        log = self.path.with_name(f'{self.path.name}-wal')
        immutable = '' if log.is_file() and log.stat().st_size else '&immutable=1'
        path = quote(str(self.path.resolve()))
        database = sqlite3.connect(f'file:{path}?mode=ro{immutable}', uri=True)
        database.execute('PRAGMA trusted_schema = OFF')
        database.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, CHUNK_BYTES.value)
        # Nothing that the file brings is executed: only plain columns of tables are read.
        database.set_authorizer(_authorise)
        left = iter(range((BAG_OPERATIONS.value + 20 * self._size) // _STEPS))
        database.set_progress_handler(lambda: next(left, None) is None, _STEPS)
        return database

    def _learn(self, database: sqlite3.Connection) -> None:
        tables = {
            name: {row[1] for row in database.execute(f'PRAGMA table_info({name})')}
            for (name,) in database.execute(
                # Tables without a page of their own are virtual, and run code.
                "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0 "
                "AND name IN ('messages', 'topics', 'schema', 'message_definitions')"
            )
        }
        if lacking := [name for name in _TABLES if name not in tables]:
            raise BagError(
                f'{self.path}: a database without table {" and ".join(lacking)}; expected one of '
                'rosbag2'
            )
        for name, columns in _TABLES.items():
            # Computed columns are not among these.
            if missing := sorted(columns - tables[name]):
                raise BagError(
                    f'{self.path}: table {name} without plain columns {", ".join(missing)}; '
                    'expected a database of rosbag2'
                )
        if 'ros_distro' in tables.get('schema', ()):
            (distro,) = database.execute('SELECT ros_distro FROM schema').fetchone() or ('',)
            self.distro = one_line(str(distro or ''), 120)
        with suppress(sqlite3.Error):
            (total,) = database.execute('SELECT total(length(data)) FROM messages').fetchone()
            self._check_size(total)
            self._order = 'timestamp, id'
        texts = dict[str, tuple[str, bytes]]()
        if tables.get('message_definitions', set()).issuperset(_DEFINITIONS):
            for name, encoding, text in database.execute(
                f'SELECT {", ".join(_DEFINITIONS)} FROM message_definitions'
            ):
                texts[str(name)] = str(encoding), str(text).encode()
        optional = [
            name if name in tables['topics'] else "''"
            for name in ('offered_qos_profiles', 'type_description_hash')
        ]
        for row in database.execute(
            f'SELECT id, name, type, serialization_format, {", ".join(optional)} FROM topics'
        ):
            self._take_topic(row, texts)

    def _check_size(self, total: float) -> None:
        if total > self._size:
            raise BagError(
                f'{self.path}: {total:.0f} bytes of messages in a file of {self._size} bytes; '
                'expected less'
            )

    def _take_topic(self, row: tuple[Any, ...], texts: dict[str, tuple[str, bytes]]) -> None:
        number, topic, type_name, encoding, qos, type_hash = row
        if not all(isinstance(text, str) for text in (topic, type_name, encoding)):
            self._report(f'{self.path}: topic {number} has no name, type or encoding as text')
            return
        self._topics[number] = topic, type_name
        try:
            offered = dump_profiles(parse_profiles(topic, qos or ''))
        except BagError as reason:
            self._report(f'{self.path}: {reason}')
            offered = ''
        schema, text = texts.get(type_name, ('', b''))
        definition = Definition(type_name, encoding, schema, text, offered, str(type_hash or ''))
        self._definitions.setdefault(topic, definition)


def _authorise(action: int, first: str | None, second: str | None, *_: str | None) -> int:
    """Allow reading, and only the functions that are used here."""
    allowed = action in _ALLOWED or (action == sqlite3.SQLITE_FUNCTION and second in _FUNCTIONS)
    return sqlite3.SQLITE_OK if allowed else sqlite3.SQLITE_DENY
