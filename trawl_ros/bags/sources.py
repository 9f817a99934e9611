# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Source of a bag's messages: its files, whatever their storage, and its metadata."""

import heapq
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

from trawl_ros.bags.storage.chunks import Allowance
from trawl_ros.bags.storage.database import Database
from trawl_ros.bags.storage.mcap_file import McapFile
from trawl_ros.bags.storage.metadata import FILE_NAME, BagMetadata, load_metadata
from trawl_ros.bags.storage.metadata_faults import metadata_faults
from trawl_ros.bags.storage.packed import PackedMessages, Unpacked
from trawl_ros.bags.storage.stored import Definition, RawMessage
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import BAG_FILES, BAG_TOPICS, NAME
from trawl_ros.core.resources import names_in, nearest, share_path

Report = Callable[[str], None]

SUFFIXES = ('.mcap', '.db3')


class StorageFile(Protocol):
    """Storage file of a bag, of any storage."""

    path: Path
    chunk_compressions: set[str]
    storage: str
    distro: str

    @property
    def indexed(self) -> bool:
        """True if messages can be found without scanning the file."""

    @property
    def damaged_chunks(self) -> int:
        """Number of damaged chunks so far."""

    @property
    def definitions(self) -> dict[str, Definition]:
        """Definition of each topic's messages."""

    def types(self) -> set[tuple[str, str]]:
        """Return all pairs (topic, type)."""

    def counts(self) -> dict[tuple[str, str], int] | None:
        """Return the number of messages by (topic, type); None if the file does not state it."""

    def messages(self) -> Iterator[RawMessage]:
        """Return all messages in the order of their log times."""


@dataclass(frozen=True)
class BagFacts:
    """Facts on a bag other than its messages.

    ``version`` (of the metadata) is None and ``distro`` '' if the bag does not state them.
    ``compression`` is '' for none. ``sizes`` gives bytes by file name.
    """

    storage: str
    version: int | None
    distro: str
    compression: str
    sizes: dict[str, int]


class BagSource:
    """Files of a bag as one stream, with the content of ``metadata.yaml``.

    Attributes
    ----------
    custom_data : dict
        Text by key from the metadata.
    """

    def __init__(
        self,
        files: list[StorageFile],
        metadata: BagMetadata | None,
        report: Report,
        unpacked: Unpacked | None = None,
    ) -> None:
        self.files = files
        self.custom_data = dict((metadata and metadata.custom_data) or {})
        self._metadata = metadata
        self._report = report
        self._packed = PackedMessages()
        # Goes, with the files in it, when the source does.
        self._unpacked = unpacked
        self.folder: Path | None = None
        check_topics(self.files[0].path, self.types())

    @property
    def facts(self) -> BagFacts:
        """Facts on the bag."""
        metadata = self._metadata
        chunks = set[str]().union(*(file.chunk_compressions for file in self.files))
        mode = _mode(metadata)
        packed = f'{metadata.compression_format} per {mode}' if metadata and mode else ''
        packed = packed or ('zstd per message' if self._packed.found else '')
        return BagFacts(
            storage=' and '.join(sorted({file.storage for file in self.files})),
            version=metadata.version if metadata else None,
            distro=(metadata and metadata.ros_distro) or self.files[0].distro,
            compression=packed or ', '.join(f'{name} per chunk' for name in sorted(chunks - {''})),
            sizes={path.name: path.stat().st_size for path in self._paths},
        )

    @property
    def _paths(self) -> list[Path]:
        return self._unpacked.packed if self._unpacked else [file.path for file in self.files]

    @property
    def definitions(self) -> dict[str, Definition]:
        """Definition of each topic's messages."""
        by_topic: dict[str, Definition] = {}
        for file in self.files:
            for topic, definition in file.definitions.items():
                by_topic.setdefault(topic, definition)
        silent = any(not definition.qos for definition in by_topic.values())
        # As text in text, it takes a second to read.
        stated = self._metadata.offered() if self._metadata and silent else {}
        for topic, definition in by_topic.items():
            if not definition.qos and topic in stated:
                by_topic[topic] = replace(definition, qos=stated[topic])
        return by_topic

    @property
    def stated_count(self) -> int | None:
        """Number of messages by the metadata; None if they do not state it."""
        counts = self._counts()
        if counts is not None:
            return sum(counts.values())
        return self._metadata.message_count if self._metadata else None

    def types(self) -> set[tuple[str, str]]:
        """Return all pairs (topic, type)."""
        return set[tuple[str, str]]().union(*(file.types() for file in self.files))

    def messages(self) -> Iterator[RawMessage]:
        """Yield all messages in the order of their log times."""
        streams = [file.messages() for file in self.files]
        size = sum(path.stat().st_size for path in self._paths)
        allowed = Allowance(self.files[0].path, size)
        if len(streams) == 1:
            merged = streams[0]
        else:
            merged = heapq.merge(*streams, key=lambda stored: stored.log_time)
        self._packed = PackedMessages()
        yield from self._packed.unpack(merged, allowed)
        self._packed.report(self.files[0].path, self._report)

    def disagreements(self) -> list[str]:
        """Return sentences on disagreements of metadata and content; none for a file cut short."""
        counts = self._counts()
        if counts is None or self._metadata is None:
            return []
        stated = self._metadata.counts()
        return [
            f'{FILE_NAME} states {stated.get(key, 0)} messages of {key[1]} on {key[0]}, '
            f'the data has {counts.get(key, 0)}'
            for key in sorted(stated.keys() | counts.keys())
            if stated.get(key, 0) != counts.get(key, 0)
        ]

    def metadata_faults(self, counts: Mapping[str, int], span: tuple[int, int] | None) -> list[str]:
        """Compare the metadata with the messages by topic and the first and last time (ns)."""
        if self._metadata is None or self.folder is None:
            return []
        storages = {file.storage for file in self.files}
        return metadata_faults(self.folder, self._metadata, storages, counts, span)

    def _counts(self) -> dict[tuple[str, str], int] | None:
        total: dict[tuple[str, str], int] = {}
        for file in self.files:
            counts = file.counts()
            if counts is None:
                return None
            for key, count in counts.items():
                total[key] = total.get(key, 0) + count
        return total


def check_topics(path: Path, topics: Collection[tuple[str, str]]) -> None:
    """Check number and names of topics and types.

    Raises
    ------
    BagError
        If they are more or longer than those of any bag.
    """
    if len(topics) > BAG_TOPICS.value:
        raise BagError(f'{path}: {len(topics)} topics; expected {BAG_TOPICS} at most')
    for name in sorted(name for pair in topics for name in pair):
        if len(name) > NAME.value or not name.isprintable():
            raise BagError(
                f'{path}: a topic or type {one_line(name, 50)!r}; expected a name of {NAME} that '
                'can be printed'
            )


def open_source(path: Path, report: Report, *, lenient: bool = False) -> BagSource:
    """Detect the kind of bag at a path, and open it.

    Parameters
    ----------
    path
        A bag's folder, or one file of it.
    report
        Takes a sentence for each thing that is wrong but can be lived with.
    lenient
        True to live with more: metadata that are missing in part, unreadable or disagree
        with the content, and files that are not there.

    Raises
    ------
    BagError
        If there is none, or, unless ``lenient``, a file of it is missing or metadata and
        content disagree.
    """
    refuse_missing(path)
    if not path.is_dir():
        return BagSource([_open_file(path, report)], None, report)
    metadata = _metadata(path, report, lenient)
    if metadata is None:
        files = sorted(file for suffix in SUFFIXES for file in path.glob(f'*{suffix}'))
        if not files:
            raise BagError(no_bag(path))
        return BagSource([_open_file(file, report) for file in files], None, report)
    return _by_metadata(path, metadata, report, lenient)


def refuse_missing(path: Path) -> None:
    """Refuse a path that leads nowhere, with the nearest name.

    Raises
    ------
    BagError
        If there is nothing of this name.
    """
    if not path.exists():
        near = nearest(path.name, [*names_in(path.parent), *names_in(share_path('bags'))])
        sample = '; the sample bag of the package is sea_trial'
        raise BagError(f'{path}: no such bag, expected {BagError.expected}{near or sample}')


def no_bag(folder: Path) -> str:
    """Say what was found in a folder that is no bag, and what to give instead."""
    names = names_in(folder)
    found = f'found {", ".join(names[:5])}{" …" * (len(names) > 5)}' if names else 'empty folder'
    bags = [name for name in names if (folder / name / FILE_NAME).is_file()]
    instead = (
        f'; give {folder / bags[0]}'
        if bags
        else '; `trawl import-log LOG --draft` begins a mapping of another kind of log'
    )
    return f'{folder}: {found}, expected a bag: {BagError.expected}{instead}'


def _by_metadata(path: Path, metadata: BagMetadata, report: Report, lenient: bool) -> BagSource:
    _check_kind(path, metadata)
    # Bags before version 4 name their files with the folder, later ones without.
    files = [path / Path(name).name for name in metadata.relative_file_paths]
    if not files:
        raise BagError(f'{path / FILE_NAME}: names no file; expected at least one')
    if len(files) > BAG_FILES.value or len(files) > len(set(files)):
        raise BagError(
            f'{path / FILE_NAME}: names {len(files)} files; expected each once, and {BAG_FILES} '
            'at most'
        )
    for file in [file for file in files if not file.is_file()]:
        sentence = f'{path}: {FILE_NAME} names {file.name}, which is not there'
        if not lenient or files == [file]:
            raise BagError(sentence)
        report(sentence)
        files.remove(file)
    unpacked = Unpacked(files) if _mode(metadata) == 'file' else None
    if unpacked:
        files = unpacked.plain
    opened = [_open_file(file, report, metadata.stated) for file in files]
    source = BagSource(opened, metadata, report, unpacked)
    source.folder = path
    for disagreement in source.disagreements():
        if not lenient:
            raise BagError(
                f'{path}: {disagreement}; expected the same (the data file can be opened alone)'
            )
        report(f'{path}: {disagreement}')
    return source


def _metadata(path: Path, report: Report, lenient: bool) -> BagMetadata | None:
    if not (path / FILE_NAME).is_file():
        if any(file.suffix in SUFFIXES for file in path.iterdir()):
            report(f'{path}: no {FILE_NAME}; every data file in the folder is read')
        return None
    try:
        return load_metadata(path / FILE_NAME)
    except BagError as reason:
        if not lenient:
            raise
        report(f'{reason}; every data file in the folder is read')
        return None


def _check_kind(path: Path, metadata: BagMetadata) -> None:
    where = path / FILE_NAME
    mode = _mode(metadata)
    if mode not in ('', 'file', 'message'):
        raise BagError(f'{where}: compression_mode {mode!r}; expected file, message or none')
    if mode and metadata.compression_format != 'zstd':
        raise BagError(
            f'{where}: compression_format {metadata.compression_format!r}; expected zstd'
        )


def _mode(metadata: BagMetadata | None) -> str:
    """Mode of rosbag2's own compression of the bag; '' without one."""
    mode = metadata.compression_mode.lower() if metadata else ''
    return '' if mode == 'none' else mode


def _open_file(
    path: Path, report: Report, stated: Callable[[], Mapping[str, Definition]] | None = None
) -> StorageFile:
    return Database(path, report) if path.suffix == '.db3' else McapFile(path, report, stated)
