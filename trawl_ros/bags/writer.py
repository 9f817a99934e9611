# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Writer of bags like ``ros2 bag record -s mcap``: a folder, ``metadata.yaml``, MCAP files.

Equal messages give equal bytes: clock, machine and path do not enter.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from trawl_ros.bags.storage.mcap_output import COMPRESSIONS, McapOutput
from trawl_ros.bags.storage.metadata import FILE_NAME, FileEntry, TopicEntry, dump_metadata
from trawl_ros.bags.storage.qos import dump_profiles, project_profile
from trawl_ros.bags.storage.stored import Definition, describe
from trawl_ros.core.errors import BagError
from trawl_ros.records.topics import NAMESPACE, find_topic


class BagWriter:
    """Writer of a new bag; use it as a context manager, or call `close`.

    Parameters
    ----------
    path
        Folder to be made. Nothing may be there yet.
    namespace
        Of the project's topics, of which some are latched.
    custom_data
        Text by key, kept in ``metadata.yaml``.
    compression
        Of the chunks: ``'zstd'``, ``'lz4'`` or ``'none'``.
    max_file_bytes
        A file that has reached this size is followed by a next one; 0 sets no limit. It ends
        with the chunk that reaches it, as in rosbag2.
    max_file_ns
        A message this much (ns) after the first of its file begins a next one; 0: no limit.

    Raises
    ------
    BagError
        If the path exists or cannot be written.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        namespace: str = NAMESPACE,
        custom_data: Mapping[str, str] | None = None,
        compression: str = 'zstd',
        max_file_bytes: int = 0,
        max_file_ns: int = 0,
    ) -> None:
        self.path = Path(path)
        if compression not in COMPRESSIONS:
            raise BagError(
                f'{self.path}: compression {compression!r}; expected one of '
                f'{", ".join(COMPRESSIONS)}'
            )
        self._namespace = namespace
        self._custom_data = dict(custom_data or {})
        self._compression = compression
        self._limits = (max_file_bytes, max_file_ns)
        self._topics: dict[str, Definition] = {}
        self._counts: dict[str, int] = {}
        self._finished: list[FileEntry] = []
        self._closed = False
        try:
            self.path.mkdir(parents=True)
        except FileExistsError:
            raise BagError(
                f'{self.path}: exists already and is not written over; expected a new path'
            ) from None
        except OSError as reason:
            raise BagError(f'{self.path}: cannot be made ({reason.strerror})') from reason
        try:
            self._file = self._next_file()
        except BagError:
            with suppress(OSError):
                self.path.rmdir()
            raise

    @property
    def counts(self) -> dict[str, int]:
        """Number of messages written so far by topic."""
        return {topic: count for topic, count in self._counts.items() if count}

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the files so far; the last one is being written."""
        return (*(file.name for file in self._finished), self._file.path.name)

    def declared(self, topic: str) -> bool:
        """True if the definition of a topic is fixed."""
        return topic in self._topics

    def declare(self, topic: str, definition: Definition) -> None:
        """Fix the definition of a topic, before its first message.

        Raises
        ------
        BagError
            If something else was said of it before.
        """
        known = self._topics.setdefault(topic, definition)
        if known != definition:
            was, wanted = (
                (known.type, definition.type)
                if known.type != definition.type
                else ('one definition', 'another')
            )
            raise BagError(f'{self.path}: {topic} has {was} so far; found {wanted}')
        self._counts.setdefault(topic, 0)

    def write(
        self,
        topic: str,
        type_name: str,
        data: bytes,
        log_time: int,
        publish_time: int | None = None,
    ) -> None:
        """Add one message.

        Parameters
        ----------
        topic
            Full name, e.g. ``/trawl/truth/winch``.
        type_name
            Message type, e.g. ``sensor_msgs/msg/JointState``.
        data
            The message as CDR.
        log_time, publish_time
            Times of reception and sending, ns; by default the same.

        Raises
        ------
        BagError
            If the type is unknown or another one than before on this topic, the time is
            negative, or the disk refuses.
        """
        if not 0 <= log_time < 2**63:
            raise BagError(f'{self.path}: {topic} at {log_time} ns; expected 0 to 2^63 ns')
        definition = self._topics.get(topic) or self._described(topic, type_name)
        if definition.type != type_name:
            raise BagError(
                f'{self.path}: {topic} has type {definition.type} so far; found {type_name}'
            )
        if self._is_full(log_time):
            self.split()
        sent = log_time if publish_time is None else publish_time
        try:
            self._file.write(topic, definition, data, log_time, sent)
        except OSError as reason:
            raise self._refused(reason) from reason
        self._counts[topic] += 1

    def split(self) -> None:
        """Finish the current file and continue in a new one."""
        try:
            self._file.finish()
        except OSError as reason:
            raise self._refused(reason) from reason
        self._finished.append(self._entry())
        self._file = self._next_file()

    def flush(self) -> None:
        """Flush all messages so far, so that readers find them.

        It ends the current chunk and updates ``metadata.yaml``, so that a process killed later
        leaves at least this much. Chunks that end early compress less well: once per second is
        often enough.
        """
        try:
            self._file.flush()
            self._write_metadata([*self._finished, self._entry()])
        except OSError as reason:
            raise self._refused(reason) from reason

    def close(self) -> None:
        """Finish the bag with its indexes, summary and metadata; a second call does nothing."""
        if self._closed:
            return
        try:
            self._file.finish()
            self._write_metadata([*self._finished, self._entry()])
        except OSError as reason:
            raise self._refused(reason) from reason
        self._closed = True

    def __enter__(self) -> 'BagWriter':
        return self

    def __exit__(self, *_: object) -> None:
        # A recording up to an error is worth as much as without one.
        self.close()

    def _is_full(self, log_time: int) -> bool:
        file, (most_bytes, longest) = self._file, self._limits
        if file.span is None:
            return False
        too_large = most_bytes > 0 and file.size >= most_bytes
        return too_large or (longest > 0 and log_time - file.span[0] > longest)

    def _described(self, topic: str, type_name: str) -> Definition:
        known = find_topic(topic, self._namespace)
        latched = known is not None and known.latched
        try:
            definition = describe(type_name, dump_profiles([project_profile(latched)]))
        except BagError as reason:
            raise BagError(f'{self.path}: {topic} has {reason}') from None
        self.declare(topic, definition)
        return definition

    def _next_file(self) -> McapOutput:
        name = f'{self.path.resolve().name}_{len(self._finished)}.mcap'
        try:
            file = McapOutput(self.path / name, self._compression)
            self._write_metadata([*self._finished, FileEntry(name, 0, None)])
        except OSError as reason:
            raise self._refused(reason) from reason
        return file

    def _entry(self) -> FileEntry:
        return FileEntry(self._file.path.name, self._file.count, self._file.span)

    def _write_metadata(self, files: Sequence[FileEntry]) -> None:
        text = dump_metadata(
            files,
            [TopicEntry(topic, self._topics[topic], n) for topic, n in self.counts.items()],
            self._custom_data,
        )
        # Replaced in one step: whoever looks, or is left with it, has a whole file.
        draft = self.path / f'.{FILE_NAME}.new'
        draft.write_text(text, encoding='utf-8')
        draft.replace(self.path / FILE_NAME)

    def _refused(self, reason: OSError) -> BagError:
        return BagError(f'{self.path}: cannot be written ({reason.strerror})')
