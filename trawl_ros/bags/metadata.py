"""``metadata.yaml``, the file beside a bag's data by which rosbag2 knows what is in it.

Written as version 8, which all current distributions read; read in any version.
"""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ConfigDict

from trawl_ros.bags.qos import dump_profiles, parse_profiles, project_profile
from trawl_ros.errors import BagError
from trawl_ros.messages.cdr import type_hash
from trawl_ros.schema import validated

FILE_NAME = 'metadata.yaml'
MAX_BYTES = 16_000_000

_VERSION = 8
_NEVER = 2**63 - 1
_ONE_LINE = 1 << 20

# The versions in C make what `BagWriter.flush` does each second cheap; not all wheels have them.
_Dumper: Any = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)
_Loader: Any = getattr(yaml, 'CSafeLoader', yaml.SafeLoader)


class _Lenient(BaseModel):
    model_config = ConfigDict(frozen=True, extra='ignore')


class _TopicMetadata(_Lenient):
    name: str
    type: str
    # A text up to version 8, a list from there on.
    offered_qos_profiles: Any = ''
    type_description_hash: str = ''


class _TopicCount(_Lenient):
    topic_metadata: _TopicMetadata
    message_count: int


class BagMetadata(_Lenient):
    """What a reader needs of ``rosbag2_bagfile_information``."""

    version: int
    storage_identifier: str
    relative_file_paths: tuple[str, ...]
    message_count: int
    topics_with_message_count: tuple[_TopicCount, ...] = ()
    compression_format: str = ''
    compression_mode: str = ''
    custom_data: dict[str, str] | None = None
    ros_distro: str = ''

    def counts(self) -> dict[tuple[str, str], int]:
        """Give the number of messages by (topic, type), of those that have any."""
        found: dict[tuple[str, str], int] = {}
        for entry in self.topics_with_message_count:
            key = (entry.topic_metadata.name, entry.topic_metadata.type)
            found[key] = found.get(key, 0) + entry.message_count
        return {key: count for key, count in found.items() if count}

    def offered(self) -> dict[str, str]:
        """Give by topic what its publishers offered, as text; left out where it makes no sense."""
        found = {}
        for entry in self.topics_with_message_count:
            topic = entry.topic_metadata
            with suppress(BagError):
                profiles = parse_profiles(topic.name, topic.offered_qos_profiles)
                found[topic.name] = dump_profiles(profiles)
        return found


def dump_metadata(
    file_name: str,
    topics: Mapping[str, tuple[str, bool, int]],
    span: tuple[int, int] | None,
    custom_data: Mapping[str, str],
) -> str:
    """Write the metadata of a bag with one MCAP file.

    Parameters
    ----------
    file_name
        Name of that file, relative to the folder.
    topics
        By full name: type, latched or not, number of messages.
    span
        First and last log time (ns); None while there is no message.
    custom_data
        What else is to be known of the bag.
    """
    start, end = span or (_NEVER, _NEVER)
    count = sum(number for _, _, number in topics.values())
    information = {
        'version': _VERSION,
        'storage_identifier': 'mcap',
        'duration': {'nanoseconds': end - start},
        'starting_time': {'nanoseconds_since_epoch': start},
        'message_count': count,
        'topics_with_message_count': [
            {
                'topic_metadata': {
                    'name': name,
                    'type': type_name,
                    'serialization_format': 'cdr',
                    'offered_qos_profiles': dump_profiles([project_profile(latched)]),
                    'type_description_hash': type_hash(type_name),
                },
                'message_count': number,
            }
            for name, (type_name, latched, number) in topics.items()
        ],
        'compression_format': '',
        'compression_mode': '',
        'relative_file_paths': [file_name],
        'files': [
            {
                'path': file_name,
                'starting_time': {'nanoseconds_since_epoch': start},
                'duration': {'nanoseconds': end - start},
                'message_count': count,
            }
        ],
        'custom_data': dict(custom_data) or None,
        'ros_distro': 'jazzy',
    }
    return _dump({'rosbag2_bagfile_information': information})


def load_metadata(path: Path) -> BagMetadata:
    """Read a ``metadata.yaml``.

    Raises
    ------
    BagError
        If the file is unreadable, not YAML, or lacks what rosbag2 always writes.
    """
    hint = 'the .mcap file beside it can be opened alone'
    try:
        with path.open('rb') as stream:
            text = stream.read(MAX_BYTES + 1)
        if len(text) > MAX_BYTES:
            raise BagError(f'{path}: larger than {MAX_BYTES} bytes; expected a bag of sane size')
        data = yaml.load(text, _Loader)
    except OSError as reason:
        raise BagError(f'{path}: cannot be read ({reason.strerror})') from reason
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError, ValueError) as reason:
        raise BagError(f'{path}: not YAML; {hint}') from reason
    if not isinstance(data, dict) or 'rosbag2_bagfile_information' not in data:
        raise BagError(f'{path}: no key rosbag2_bagfile_information; {hint}')
    return validated(
        BagMetadata,
        data['rosbag2_bagfile_information'],
        path,
        BagError,
        prefix='rosbag2_bagfile_information',
    )


def _dump(data: Any) -> str:
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=_ONE_LINE)
