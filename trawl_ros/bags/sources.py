"""Where a bag's messages come from: one or several MCAP files, or a database of older bags."""

import heapq
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Protocol

from mcap.records import Message
from rosbags.interfaces import ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag2 import Reader, ReaderError

from trawl_ros.bags.mcap_file import Definition, McapFile
from trawl_ros.bags.metadata import FILE_NAME, BagMetadata, load_metadata
from trawl_ros.bags.qos import dump_profiles
from trawl_ros.errors import BagError

Report = Callable[[str], None]
Found = tuple[str, str, Message]
"""Topic, type and message."""


class Source(Protocol):
    """What `Bag` reads from, whatever the storage."""

    @property
    def definitions(self) -> dict[str, Definition]:
        """What is known of each topic's messages."""

    @property
    def stated_count(self) -> int | None:
        """Number of messages the bag claims to have; None if it does not say."""

    @property
    def custom_data(self) -> dict[str, str]:
        """Text by key from the metadata."""

    def types(self) -> set[tuple[str, str]]:
        """Give all (topic, type) there are."""

    def messages(self) -> Iterator[Found]:
        """Give all messages in the order of their log times."""


def open_source(path: Path, report: Report) -> Source:
    """Find out what kind of bag lies at a path, and open it.

    Raises
    ------
    BagError
        If there is none, a file of it is missing, or metadata and content disagree.
    """
    if not path.exists():
        raise BagError(f'{path}: no such bag')
    if path.is_file():
        if path.suffix == '.db3':
            return _Database(path, None)
        return _McapFiles([McapFile(path, report)], None)
    if not (path / FILE_NAME).is_file():
        files = sorted(path.glob('*.mcap'))
        if not files:
            raise BagError(f'{path}: neither {FILE_NAME} nor an .mcap file; expected a bag')
        report(f'{path}: no {FILE_NAME}; every .mcap file in the folder is read')
        return _McapFiles([McapFile(file, report) for file in files], None)
    metadata = load_metadata(path / FILE_NAME)
    if metadata.storage_identifier == 'sqlite3' or metadata.compression_mode not in ('', 'none'):
        return _Database(path, metadata)
    if metadata.storage_identifier != 'mcap':
        raise BagError(
            f'{path / FILE_NAME}: storage {metadata.storage_identifier!r}; expected mcap'
        )
    # Bags before version 4 name their files with the folder, later ones without.
    files = [path / Path(name).name for name in metadata.relative_file_paths]
    for file in files:
        if not file.is_file():
            raise BagError(f'{path}: {FILE_NAME} names {file.name}, which is not there')
    if not files:
        raise BagError(f'{path / FILE_NAME}: names no file; expected at least one')
    source = _McapFiles([McapFile(file, report) for file in files], metadata)
    source.compare(path)
    return source


class _McapFiles:
    def __init__(self, files: list[McapFile], metadata: BagMetadata | None) -> None:
        self._files = files
        self._metadata = metadata
        self.custom_data = dict((metadata and metadata.custom_data) or {})

    @property
    def definitions(self) -> dict[str, Definition]:
        found: dict[str, Definition] = {}
        for file in self._files:
            for topic, definition in file.definitions.items():
                found.setdefault(topic, definition)
        stated = self._metadata.offered() if self._metadata else {}
        for topic, definition in found.items():
            if not definition.qos and topic in stated:
                found[topic] = replace(definition, qos=stated[topic])
        return found

    @property
    def stated_count(self) -> int | None:
        counts = self._counts()
        if counts is not None:
            return sum(counts.values())
        return self._metadata.message_count if self._metadata else None

    def types(self) -> set[tuple[str, str]]:
        return set().union(*(file.types() for file in self._files))

    def messages(self) -> Iterator[Found]:
        streams = (file.messages() for file in self._files)
        for stored in heapq.merge(*streams, key=lambda stored: stored.message.log_time):
            yield stored.topic, stored.type, stored.message

    def compare(self, path: Path) -> None:
        """Refuse a bag whose metadata and content disagree; a file cut short says nothing."""
        counts = self._counts()
        if counts is None or self._metadata is None:
            return
        stated = self._metadata.counts()
        for key in sorted(stated.keys() | counts.keys()):
            if stated.get(key, 0) != counts.get(key, 0):
                topic, type_name = key
                raise BagError(
                    f'{path}: {FILE_NAME} states {stated.get(key, 0)} messages of {type_name} on '
                    f'{topic}, the data has {counts.get(key, 0)}; '
                    'expected the same (the .mcap file can be opened alone)'
                )

    def _counts(self) -> dict[tuple[str, str], int] | None:
        total: dict[tuple[str, str], int] = {}
        for file in self._files:
            counts = file.counts()
            if counts is None:
                return None
            for key, count in counts.items():
                total[key] = total.get(key, 0) + count
        return total


class _Database:
    """Bags in SQLite, and compressed ones, by way of ``rosbags``."""

    def __init__(self, path: Path, metadata: BagMetadata | None) -> None:
        self._path = path
        self.custom_data = dict((metadata and metadata.custom_data) or {})
        try:
            with Reader(path) as reader:
                self._connections = list(reader.connections)
                self.stated_count: int | None = reader.message_count
        except (ReaderError, OSError) as reason:
            raise BagError(f'{path}: cannot be read ({reason})') from reason

    @property
    def definitions(self) -> dict[str, Definition]:
        encodings = {
            MessageDefinitionFormat.MSG: 'ros2msg',
            MessageDefinitionFormat.IDL: 'ros2idl',
            MessageDefinitionFormat.NONE: '',
        }
        return {
            connection.topic: Definition(
                connection.msgtype,
                'cdr',
                encodings[connection.msgdef.format],
                connection.msgdef.data.encode(),
                dump_profiles(connection.ext.offered_qos_profiles)
                if isinstance(connection.ext, ConnectionExtRosbag2)
                else '',
                connection.digest,
            )
            for connection in self._connections
        }

    def types(self) -> set[tuple[str, str]]:
        return {(connection.topic, connection.msgtype) for connection in self._connections}

    def messages(self) -> Iterator[Found]:
        try:
            with Reader(self._path) as reader:
                for connection, stamp, data in reader.messages():
                    message = Message(connection.id, stamp, bytes(data), stamp, 0)
                    yield connection.topic, connection.msgtype, message
        except (ReaderError, OSError) as reason:
            raise BagError(f'{self._path}: cannot be read ({reason})') from reason
