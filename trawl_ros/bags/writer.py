"""Bags as ``ros2 bag record -s mcap`` leaves them: a folder, ``metadata.yaml``, one MCAP file.

The same messages give the same bytes: nothing of the clock, the machine or the path goes in.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from mcap.writer import Writer

from trawl_ros.bags.metadata import FILE_NAME, dump_metadata
from trawl_ros.bags.qos import dump_profiles, project_profile
from trawl_ros.errors import BagError
from trawl_ros.messages.cdr import STORE, definition, type_hash
from trawl_ros.messages.topics import NAMESPACE, find_topic

CHUNK_BYTES = 1 << 20
LIBRARY = 'trawl_ros'
"""Stands in the file's header in place of a version, which would change the bytes."""


@dataclass
class _Channel:
    number: int
    type: str
    latched: bool
    count: int = 0


class BagWriter:
    """Writes a new bag; use it as a context manager, or call `close`.

    Parameters
    ----------
    path
        Folder to be made. Nothing may be there yet.
    namespace
        Where the project's topics live, to tell which of them are latched.
    custom_data
        Text by key, kept in ``metadata.yaml``.

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
    ) -> None:
        self.path = Path(path)
        self._namespace = namespace
        self._custom_data = dict(custom_data or {})
        self._channels: dict[str, _Channel] = {}
        self._schemas: dict[str, int] = {}
        self._span: tuple[int, int] | None = None
        self._file_name = f'{self.path.resolve().name}_0.mcap'
        try:
            self.path.mkdir(parents=True)
        except FileExistsError:
            raise BagError(
                f'{self.path}: exists already and is not written over; expected a new path'
            ) from None
        except OSError as reason:
            raise BagError(f'{self.path}: cannot be made ({reason.strerror})') from reason
        self._file = (self.path / self._file_name).open('xb')
        self._mcap = Writer(self._file, chunk_size=CHUNK_BYTES)
        self._mcap.start(profile='ros2', library=LIBRARY)
        self.flush()

    @property
    def counts(self) -> dict[str, int]:
        """Number of messages written so far by topic."""
        return {topic: channel.count for topic, channel in self._channels.items()}

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
            When it was received and sent, ns; by default the same.

        Raises
        ------
        BagError
            If the type is unknown or another one than before on this topic, the time is
            negative, or the disk refuses.
        """
        if not 0 <= log_time < 2**63:
            raise BagError(f'{self.path}: {topic} at {log_time} ns; expected 0 to 2^63 ns')
        channel = self._channels.get(topic) or self._register(topic, type_name)
        if channel.type != type_name:
            raise BagError(
                f'{self.path}: {topic} has type {channel.type} so far; found {type_name}'
            )
        try:
            self._mcap.add_message(
                channel.number,
                log_time=log_time,
                data=data,
                publish_time=log_time if publish_time is None else publish_time,
                sequence=channel.count,
            )
        except OSError as reason:
            raise self._refused(reason) from reason
        channel.count += 1
        first, last = self._span or (log_time, log_time)
        self._span = min(first, log_time), max(last, log_time)

    def flush(self) -> None:
        """Put all that was written so far within reach of readers.

        Ends the chunk in progress and brings ``metadata.yaml`` up to date, so that a process
        killed later leaves at least this much. Chunks that end early compress less well: once
        per second is often enough.
        """
        try:
            self._mcap.flush()
            self._write_metadata()
        except OSError as reason:
            raise self._refused(reason) from reason

    def close(self) -> None:
        """Finish the bag with its indexes, summary and metadata; a second call does nothing."""
        if self._file.closed:
            return
        try:
            self._mcap.finish()
            self._file.close()
            self._write_metadata()
        except OSError as reason:
            raise self._refused(reason) from reason

    def __enter__(self) -> 'BagWriter':
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        # What was recorded before an error is worth as much as without one.
        self.close()

    def _register(self, topic: str, type_name: str) -> _Channel:
        if type_name not in STORE.types:
            raise BagError(
                f'{self.path}: {topic} has type {type_name}, whose definition is unknown'
            )
        known = find_topic(topic, self._namespace)
        latched = known is not None and known.latched
        if type_name not in self._schemas:
            self._schemas[type_name] = self._mcap.register_schema(
                type_name, 'ros2msg', definition(type_name).encode()
            )
        number = self._mcap.register_channel(
            topic,
            'cdr',
            self._schemas[type_name],
            {
                'offered_qos_profiles': dump_profiles([project_profile(latched)]),
                'topic_type_hash': type_hash(type_name),
            },
        )
        self._channels[topic] = _Channel(number, type_name, latched)
        return self._channels[topic]

    def _write_metadata(self) -> None:
        topics = {
            topic: (channel.type, channel.latched, channel.count)
            for topic, channel in self._channels.items()
        }
        text = dump_metadata(self._file_name, topics, self._span, self._custom_data)
        # Replaced in one step: whoever looks, or is left with it, has a whole file.
        draft = self.path / f'.{FILE_NAME}.new'
        draft.write_text(text, encoding='utf-8')
        draft.replace(self.path / FILE_NAME)

    def _refused(self, reason: OSError) -> BagError:
        return BagError(f'{self.path}: cannot be written ({reason.strerror})')
