# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""``metadata.yaml``, the file next to a bag's data in which rosbag2 describes the bag.

It is written as version 8, which all current distributions read; all versions are read.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, ConfigDict, StringConstraints

from trawl_ros.bags.storage.qos import dump_profiles, parse_profiles
from trawl_ros.bags.storage.stored import Definition
from trawl_ros.core.errors import BagError
from trawl_ros.core.foreign import read_whole, short
from trawl_ros.core.limits import METADATA_BYTES, METADATA_DEPTH, METADATA_VALUES, NAME
from trawl_ros.core.schema import validated

FILE_NAME = 'metadata.yaml'

_VERSION = 8
_DISTRIBUTION = 'jazzy'
_NEVER = 2**63 - 1
_ONE_LINE = 1 << 20

# The versions in C make what `BagWriter.flush` does each second cheap; not all wheels have them.
_Dumper: Any = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)
_Loader: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)


_Name = Annotated[str, StringConstraints(max_length=NAME.value)]


class _Lenient(BaseModel):
    model_config = ConfigDict(frozen=True, extra='ignore')


class _TopicMetadata(_Lenient):
    name: _Name
    type: _Name
    # A text up to version 8, a list from there on.
    offered_qos_profiles: Any = ''
    type_description_hash: str = ''


class _TopicCount(_Lenient):
    topic_metadata: _TopicMetadata
    message_count: int


class BagMetadata(_Lenient):
    """Content of ``rosbag2_bagfile_information`` that a reader needs."""

    version: int
    storage_identifier: _Name
    relative_file_paths: tuple[_Name, ...]
    message_count: int
    topics_with_message_count: tuple[_TopicCount, ...] = ()
    compression_format: _Name = ''
    compression_mode: _Name = ''
    custom_data: dict[str, str] | None = None
    ros_distro: _Name = ''
    starting_time: dict[str, int] = {}
    duration: dict[str, int] = {}

    @property
    def span(self) -> tuple[int, int] | None:
        """First and last log time (ns) as stated; None if not stated."""
        start = self.starting_time.get('nanoseconds_since_epoch')
        lasts = self.duration.get('nanoseconds')
        return None if start is None or lasts is None else (start, start + lasts)

    def counts(self) -> dict[tuple[str, str], int]:
        """Return the number of messages by (topic, type), without those that have none."""
        counts: dict[tuple[str, str], int] = {}
        for entry in self.topics_with_message_count:
            key = (entry.topic_metadata.name, entry.topic_metadata.type)
            counts[key] = counts.get(key, 0) + entry.message_count
        return {key: count for key, count in counts.items() if count}

    def stated(self) -> dict[str, Definition]:
        """Return the stated properties of each topic, for files that lost them."""
        offered = self.offered()
        entries = [entry.topic_metadata for entry in self.topics_with_message_count]
        return {
            topic.name: Definition(
                topic.type,
                'cdr',
                '',
                b'',
                qos=offered.get(topic.name, ''),
                type_hash=topic.type_description_hash,
            )
            for topic in entries
        }

    def offered(self) -> dict[str, str]:
        """Offered QoS by topic, as text; invalid ones are left out."""
        by_topic = {}
        for entry in self.topics_with_message_count:
            topic = entry.topic_metadata
            with suppress(BagError):
                profiles = parse_profiles(topic.name, topic.offered_qos_profiles)
                by_topic[topic.name] = dump_profiles(profiles)
        return by_topic


@dataclass(frozen=True)
class FileEntry:
    """File of a bag: name, messages, first and last log time (ns; None without messages)."""

    name: str
    count: int
    span: tuple[int, int] | None

    def as_metadata(self) -> dict[str, Any]:
        """Return the entry of ``files``."""
        return {'path': self.name, **_extent([self])}


@dataclass(frozen=True)
class TopicEntry:
    """Topic of a bag: full name, its definition, messages."""

    name: str
    said: Definition
    count: int

    def as_metadata(self) -> dict[str, Any]:
        """Return the entry of ``topics_with_message_count``."""
        return {
            'topic_metadata': {
                'name': self.name,
                'type': self.said.type,
                'serialization_format': self.said.message_encoding,
                'offered_qos_profiles': self.said.qos,
                'type_description_hash': self.said.type_hash,
            },
            'message_count': self.count,
        }


def dump_metadata(
    files: Sequence[FileEntry], topics: Sequence[TopicEntry], custom_data: Mapping[str, str]
) -> str:
    """Write the metadata of a bag of MCAP files.

    Parameters
    ----------
    files
        In the order in which they were written.
    topics
        Those with messages.
    custom_data
        Further text by key.
    """
    extent = _extent(files)
    information = {
        'version': _VERSION,
        'storage_identifier': 'mcap',
        'duration': extent['duration'],
        'starting_time': extent['starting_time'],
        'message_count': extent['message_count'],
        'topics_with_message_count': [topic.as_metadata() for topic in topics],
        # Of rosbag2's own compression of files or messages; chunks of MCAP have theirs.
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file.name for file in files],
        'files': [file.as_metadata() for file in files],
        'custom_data': dict(custom_data) or None,
        'ros_distro': _DISTRIBUTION,
    }
    return _dump({'rosbag2_bagfile_information': information})


def _extent(files: Sequence[FileEntry]) -> dict[str, Any]:
    """Start, duration and message count of files."""
    spans = [file.span for file in files if file.span]
    start = min((first for first, _ in spans), default=_NEVER)
    end = max((last for _, last in spans), default=_NEVER)
    return {
        'starting_time': {'nanoseconds_since_epoch': start},
        'duration': {'nanoseconds': end - start},
        'message_count': sum(file.count for file in files),
    }


def load_metadata(path: Path) -> BagMetadata:
    """Read a ``metadata.yaml``.

    Raises
    ------
    BagError
        If the file is unreadable, not YAML, or lacks what rosbag2 always writes.
    """
    return validated(
        BagMetadata,
        read_information(path),
        path,
        BagError,
        prefix='rosbag2_bagfile_information',
    )


def read_information(path: Path) -> Any:
    """Read the node ``rosbag2_bagfile_information``, unchecked.

    Raises
    ------
    BagError
        If the file is unreadable, not YAML, or has no such key.
    """
    hint = 'the .mcap file next to it can be opened alone'
    text = read_whole(path, METADATA_BYTES, BagError, 'a bag of sane size')
    try:
        data = load_plain(text)
    # Tags bring along whatever their constructors raise.
    except Exception as reason:
        raise BagError(f'{path}: not YAML ({short(reason)}); {hint}') from reason
    if not isinstance(data, dict) or 'rosbag2_bagfile_information' not in data:
        raise BagError(f'{path}: no key rosbag2_bagfile_information; {hint}')
    return data['rosbag2_bagfile_information']


def load_plain(text: bytes | str) -> Any:
    """Read YAML of a bag with the C parser, with limits on depth and on the size of aliases.

    Raises
    ------
    Exception
        Whatever the parser raises if it is none.
    """
    total = 0
    sizes: dict[str | None, int] = {}
    above: list[tuple[str | None, int]] = []
    # The composer of the C loader goes down by recursion, and takes the interpreter with it.
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.AliasEvent):
            # KeyError: of something that is not finished, so it would hold itself.
            total += sizes[event.anchor]
        elif isinstance(event, yaml.CollectionStartEvent):
            above.append((event.anchor, total))
            total += 1
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, before = above.pop()
            sizes[anchor] = total - before
        elif isinstance(event, yaml.ScalarEvent):
            sizes[event.anchor] = 1
            total += 1
        if len(above) > METADATA_DEPTH.value or total > METADATA_VALUES.value:
            raise ValueError(f'expected {METADATA_VALUES} in {METADATA_DEPTH} at most')
    return yaml.load(text, _Loader)


def _dump(data: Any) -> str:
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=_ONE_LINE)
