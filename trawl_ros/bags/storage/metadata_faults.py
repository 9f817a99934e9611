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
from typing import Any

import yaml

from trawl_ros.bags.storage.metadata import FILE_NAME, BagMetadata, read_information

# What a value has to be: a type, a check, [what each item of a list has to be], or the keys of a
# map, each with the version that brought it and what its value has to be.
_Wanted = type | Callable[[Any], bool] | list[Any] | Mapping[str, tuple[int, Any]]


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**64


def _is_count_or_text(value: Any) -> bool:
    return _is_count(value) or isinstance(value, str)


def _is_custom(value: Any) -> bool:
    # Nothing, where nothing was given: an empty map is written as null.
    return value is None or (
        isinstance(value, dict) and all(isinstance(text, str) for text in value.values())
    )


_DURATION = {'nanoseconds': (0, _is_count)}
_START = {'nanoseconds_since_epoch': (0, _is_count)}
_TIME = {'sec': (4, _is_count), 'nsec': (4, _is_count)}
_FILE = {
    'path': (5, str),
    'starting_time': (5, _START),
    'duration': (5, _DURATION),
    'message_count': (5, _is_count),
}
_PROFILES = [
    {
        'history': (4, _is_count_or_text),
        'depth': (4, _is_count),
        'reliability': (4, _is_count_or_text),
        'durability': (4, _is_count_or_text),
        'deadline': (4, _TIME),
        'lifespan': (4, _TIME),
        'liveliness': (4, _is_count_or_text),
        'liveliness_lease_duration': (4, _TIME),
        'avoid_ros_namespace_conventions': (4, bool),
    }
]
_TOPIC_METADATA = {
    'name': (0, str),
    'type': (0, str),
    'serialization_format': (0, str),
    'offered_qos_profiles': (4, _PROFILES),
    'type_description_hash': (7, str),
}
_TOPIC = {'topic_metadata': (0, _TOPIC_METADATA), 'message_count': (0, _is_count)}
_BAG = {
    'version': (0, _is_count),
    'storage_identifier': (0, str),
    'duration': (0, _DURATION),
    'starting_time': (0, _START),
    'message_count': (0, _is_count),
    'topics_with_message_count': (0, [_TOPIC]),
    'compression_format': (3, str),
    'compression_mode': (3, str),
    'relative_file_paths': (0, [str]),
    'files': (5, [_FILE]),
    'custom_data': (6, _is_custom),
    'ros_distro': (8, str),
}


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
    node = information if isinstance(information, dict) else {}
    version = node.get('version')
    return list(_lacking('', node, _BAG, version if isinstance(version, int) else 0))


def _lacking(where: str, value: Any, wanted: _Wanted, version: int) -> Iterator[str]:
    if wanted is _PROFILES and isinstance(value, str):
        if version >= 9:
            yield where
        value = _parsed(value)
    if isinstance(wanted, Mapping) and isinstance(value, dict):
        for key, (since, inner) in wanted.items():
            if version >= since:
                path = f'{where}.{key}' if where else key
                # No value of YAML is an ellipsis, so a missing key fits nothing.
                yield from _lacking(path, value.get(key, ...), inner, version)
    elif isinstance(wanted, list) and isinstance(value, list):
        for number, item in enumerate(value):
            yield from _lacking(f'{where}[{number}]', item, wanted[0], version)
    elif not _fits(value, wanted):
        yield where


def _fits(value: Any, wanted: _Wanted) -> bool:
    if isinstance(wanted, type):
        return isinstance(value, wanted)
    return callable(wanted) and wanted(value)


def _parsed(text: str) -> Any:
    """Return the profiles in a text of up to version 8; none in an empty one."""
    try:
        return yaml.safe_load(text) or []
    except yaml.YAMLError:
        return [None]
