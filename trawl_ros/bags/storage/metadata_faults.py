# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Faults of ``metadata.yaml``: against the data, and against what rosbag2 requires.

Keys, kinds and the version that brought each are those of the decoders in
``rosbag2_storage/include/rosbag2_storage/yaml.hpp`` and ``rosbag2_storage/src/rosbag2_storage/
qos.cpp`` of rosbag2 (branches jazzy and rolling): there a key that is missing, or of another
kind, ends the reading of the bag.
"""

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import yaml

from trawl_ros.bags.storage.metadata import FILE_NAME, BagMetadata, read_information

_Check = Callable[[Any], bool]


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**64


def _is_list(value: Any) -> bool:
    return isinstance(value, list)


def _is_texts(value: Any) -> bool:
    return isinstance(value, list) and all(map(_is_text, value))


def _is_custom(value: Any) -> bool:
    # Nothing, where nothing was given: an empty map is written as null.
    return value is None or (isinstance(value, dict) and all(map(_is_text, value.values())))


def _is_map(value: Any) -> bool:
    return isinstance(value, dict)


# Key → version that brought it, and what it has to be.
BAG: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {
        'version': (0, _is_count),
        'storage_identifier': (0, _is_text),
        'duration': (0, _is_map),
        'starting_time': (0, _is_map),
        'message_count': (0, _is_count),
        'topics_with_message_count': (0, _is_list),
        'compression_format': (3, _is_text),
        'compression_mode': (3, _is_text),
        'relative_file_paths': (0, _is_texts),
        'files': (5, _is_list),
        'custom_data': (6, _is_custom),
        'ros_distro': (8, _is_text),
    }
)
DURATION: Mapping[str, tuple[int, _Check]] = MappingProxyType({'nanoseconds': (0, _is_count)})
START: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {'nanoseconds_since_epoch': (0, _is_count)}
)
FILE: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {
        'path': (5, _is_text),
        'starting_time': (5, _is_map),
        'duration': (5, _is_map),
        'message_count': (5, _is_count),
    }
)
TOPIC: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {'topic_metadata': (0, _is_map), 'message_count': (0, _is_count)}
)
TOPIC_METADATA: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {
        'name': (0, _is_text),
        'type': (0, _is_text),
        'serialization_format': (0, _is_text),
        'offered_qos_profiles': (4, lambda value: _is_text(value) or _is_list(value)),
        'type_description_hash': (7, _is_text),
    }
)
QOS: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {
        'history': (4, lambda value: _is_count(value) or _is_text(value)),
        'depth': (4, _is_count),
        'reliability': (4, lambda value: _is_count(value) or _is_text(value)),
        'durability': (4, lambda value: _is_count(value) or _is_text(value)),
        'deadline': (4, _is_map),
        'lifespan': (4, _is_map),
        'liveliness': (4, lambda value: _is_count(value) or _is_text(value)),
        'liveliness_lease_duration': (4, _is_map),
        'avoid_ros_namespace_conventions': (4, lambda value: isinstance(value, bool)),
    }
)
TIME: Mapping[str, tuple[int, _Check]] = MappingProxyType(
    {'sec': (4, _is_count), 'nsec': (4, _is_count)}
)


def metadata_faults(
    path: Path,
    metadata: BagMetadata,
    storages: Collection[str],
    counts: Mapping[str, int],
    span: tuple[int, int] | None,
) -> list[str]:
    """Compare the metadata of a bag with its content.

    Parameters
    ----------
    path
        The bag's folder.
    metadata
        Content of its ``metadata.yaml``.
    storages
        Kinds of its files, ``mcap`` or ``sqlite3``.
    counts
        Messages by full topic name, all of which were read.
    span
        First and last log time (ns); None without messages.

    Returns
    -------
    list of str
        A sentence for each fault.
    """
    file = path / FILE_NAME
    faults = []
    if missing := lacking(read_information(file)):
        faults.append(f'{file}: rosbag2 misses {", ".join(missing)}')
    if {metadata.storage_identifier} != set(storages):
        faults.append(
            f'{file}: storage {metadata.storage_identifier!r}; the files are '
            f'{" and ".join(sorted(storages))}'
        )
    stated: Counter[str] = Counter()
    for (topic, _), count in metadata.counts().items():
        stated[topic] += count
    read = Counter(counts)
    if stated != read or metadata.message_count != read.total():
        faults.append(
            f'{path}: {FILE_NAME} and the data disagree: {metadata.message_count} messages are '
            f'stated, {stated.total()} by topic; {read.total()} can be read'
        )
    if span and metadata.span != span:
        faults.append(f'{path}: {FILE_NAME} states other times than the data have')
    return faults


def lacking(information: Any) -> list[str]:
    """Return the keys that rosbag2 requires and that are missing, by path.

    Parameters
    ----------
    information
        Content of ``rosbag2_bagfile_information``.
    """
    version = information.get('version') if isinstance(information, dict) else None
    return list(_bag(information, version if isinstance(version, int) else 0))


def _bag(node: Any, version: int) -> Iterator[str]:
    yield from _keys('', node, BAG, version)
    if not isinstance(node, dict):
        return
    yield from _keys('duration', node.get('duration'), DURATION, version)
    yield from _keys('starting_time', node.get('starting_time'), START, version)
    for number, topic in enumerate(_listed(node, 'topics_with_message_count')):
        where = f'topics_with_message_count[{number}]'
        yield from _keys(where, topic, TOPIC, version)
        inner = topic.get('topic_metadata') if isinstance(topic, dict) else None
        yield from _topic(f'{where}.topic_metadata', inner, version)
    for number, file in enumerate(_listed(node, 'files') if version >= 5 else ()):
        where = f'files[{number}]'
        yield from _keys(where, file, FILE, version)
        if isinstance(file, dict):
            yield from _keys(f'{where}.duration', file.get('duration'), DURATION, version)
            yield from _keys(f'{where}.starting_time', file.get('starting_time'), START, version)


def _topic(where: str, node: Any, version: int) -> Iterator[str]:
    yield from _keys(where, node, TOPIC_METADATA, version)
    offered = node.get('offered_qos_profiles') if isinstance(node, dict) else None
    if isinstance(offered, str) and version >= 9:
        yield f'{where}.offered_qos_profiles'
    if isinstance(offered, str):
        offered = _parsed(offered)
    for number, profile in enumerate(offered if isinstance(offered, list) else ()):
        inner = f'{where}.offered_qos_profiles[{number}]'
        yield from _keys(inner, profile, QOS, version)
        for key in ('deadline', 'lifespan', 'liveliness_lease_duration'):
            if isinstance(profile, dict):
                yield from _keys(f'{inner}.{key}', profile.get(key), TIME, version)


def _parsed(text: str) -> Any:
    try:
        return yaml.safe_load(text)
    except yaml.YAMLError:
        return [None]


def _listed(node: Mapping[str, Any], key: str) -> list[Any]:
    value = node.get(key)
    return value if isinstance(value, list) else []


def _keys(
    where: str, node: Any, wanted: Mapping[str, tuple[int, _Check]], version: int
) -> Iterator[str]:
    for key, (since, fits) in wanted.items():
        if version >= since and not (isinstance(node, dict) and key in node and fits(node[key])):
            yield f'{where}.{key}' if where else key
