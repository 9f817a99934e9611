"""Faults of ``metadata.yaml``: one judgement for `trawl bag check` and `trawl bag repair`."""

from collections import Counter
from collections.abc import Collection, Mapping
from pathlib import Path

from trawl_ros.bags.storage.metadata import FILE_NAME, BagMetadata, read_information
from trawl_ros.bags.storage.rosbag2_keys import lacking


def metadata_faults(
    path: Path,
    metadata: BagMetadata,
    storages: Collection[str],
    counts: Mapping[str, int],
    span: tuple[int, int] | None,
) -> list[str]:
    """Hold the metadata of a bag against its content.

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
