"""One SQLite file of rosbag2: the storage of Foxy to Humble by default, and of later ones by wish.

A database is read as it lies there, without its ``metadata.yaml``: that is compared elsewhere.
"""

import sqlite3
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any
from urllib.parse import quote

from mcap.records import Message

from trawl_ros.bags.chunks import MAX_CHUNK_BYTES
from trawl_ros.bags.qos import dump_profiles, parse_profiles
from trawl_ros.bags.stored import Definition, Stored
from trawl_ros.errors import BagError

_TABLES = ('messages', 'topics')
_READ = (
    'SELECT topic_id, timestamp, data FROM messages WHERE length(data) <= ? ORDER BY timestamp, id'
)


class Database:
    """An SQLite file of a bag, opened for reading.

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
        self._topics: dict[int, tuple[str, str]] = {}
        self._definitions: dict[str, Definition] = {}
        try:
            with closing(self._connect()) as database:
                self._learn(database)
        except (sqlite3.Error, UnicodeDecodeError) as reason:
            raise BagError(f'{path}: cannot be read ({reason}); expected an SQLite bag') from reason

    @property
    def indexed(self) -> bool:
        """Whether messages can be found without going through the file: always so here."""
        return True

    @property
    def definitions(self) -> dict[str, Definition]:
        """What is known of each topic's messages."""
        return dict(self._definitions)

    def types(self) -> set[tuple[str, str]]:
        """Give all (topic, type) there are."""
        return set(self._topics.values())

    def counts(self) -> dict[tuple[str, str], int] | None:
        """Count the messages by (topic, type); None if the database refuses."""
        try:
            with closing(self._connect()) as database:
                rows = database.execute('SELECT topic_id, count(*) FROM messages GROUP BY topic_id')
                found: Counter[tuple[str, str]] = Counter()
                for number, count in rows:
                    if number in self._topics:
                        found[self._topics[number]] += count
                return dict(found)
        except sqlite3.Error:
            return None

    def messages(self) -> Iterator[Stored]:
        """Give all messages in the order of their times, as far as the database can be read."""
        lost: Counter[str] = Counter()
        read = 0
        try:
            with closing(self._connect()) as database:
                for number, stamp, data in database.execute(_READ, (MAX_CHUNK_BYTES,)):
                    read += 1
                    if number not in self._topics:
                        lost[f'of topic {number}, whose description is missing'] += 1
                    elif not isinstance(stamp, int) or not isinstance(data, bytes):
                        lost['that are not bytes with a time'] += 1
                    else:
                        topic, type_name = self._topics[number]
                        message = Message(number, stamp, data, stamp, 0)
                        yield Stored(topic, type_name, message)
                (there,) = database.execute('SELECT count(*) FROM messages').fetchone()
                if there > read:
                    lost[f'of more than {MAX_CHUNK_BYTES} bytes'] += there - read
        except sqlite3.Error as reason:
            self._report(
                f'{self.path}: damaged behind {read} messages ({reason}); what stands before is '
                'used'
            )
        for which, count in lost.items():
            self._report(f'{self.path}: {count} messages {which} were left out')

    def _connect(self) -> sqlite3.Connection:
        if not self.path.is_file():
            raise BagError(f'{self.path}: no such file')
        # A recorder that was killed leaves its last messages in a log beside the database, which
        # is only looked at when the file is not said to be immutable.
        log = self.path.with_name(f'{self.path.name}-wal')
        immutable = '' if log.is_file() and log.stat().st_size else '&immutable=1'
        path = quote(str(self.path.resolve()))
        database = sqlite3.connect(f'file:{path}?mode=ro{immutable}', uri=True)
        database.execute('PRAGMA trusted_schema = OFF')
        return database

    def _learn(self, database: sqlite3.Connection) -> None:
        tables = {
            name
            for (name,) in database.execute('SELECT name FROM sqlite_master WHERE type="table"')
        }
        if missing := [name for name in _TABLES if name not in tables]:
            raise BagError(
                f'{self.path}: a database without table {" and ".join(missing)}; expected one of '
                'rosbag2'
            )
        if 'schema' in tables:
            (self.distro,) = database.execute('SELECT ros_distro FROM schema').fetchone() or ('',)
        texts = dict[str, tuple[str, bytes]]()
        if 'message_definitions' in tables:
            for name, encoding, text in database.execute(
                'SELECT topic_type, encoding, encoded_message_definition FROM message_definitions'
            ):
                texts[name] = str(encoding), str(text).encode()
        columns = {row[1] for row in database.execute('PRAGMA table_info(topics)')}
        optional = [
            name if name in columns else "''"
            for name in ('offered_qos_profiles', 'type_description_hash')
        ]
        for row in database.execute(
            f'SELECT id, name, type, serialization_format, {", ".join(optional)} FROM topics'
        ):
            self._take_topic(row, texts)

    def _take_topic(self, row: tuple[Any, ...], texts: dict[str, tuple[str, bytes]]) -> None:
        number, topic, type_name, encoding, qos, type_hash = row
        self._topics[number] = topic, type_name
        try:
            offered = dump_profiles(parse_profiles(topic, qos or ''))
        except BagError as reason:
            self._report(f'{self.path}: {reason}')
            offered = ''
        schema, text = texts.get(type_name, ('', b''))
        definition = Definition(type_name, encoding, schema, text, offered, type_hash or '')
        self._definitions.setdefault(topic, definition)
