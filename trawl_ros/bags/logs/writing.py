"""Bag of a log's samples, in the order of their times."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from trawl_ros.bags.writer import BagWriter
from trawl_ros.core.errors import BagError, LogError
from trawl_ros.core.files import new_folder, written_folder
from trawl_ros.core.limits import LOG_READINGS
from trawl_ros.core.stamps import LOG_APART_NS, judge_stamps
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.to_messages import sample_message
from trawl_ros.records.samples import Sample
from trawl_ros.records.topics import absolute


@dataclass(frozen=True)
class Imported:
    """Result of an import.

    ``rows`` were read, ``counts`` are messages by full topic name, ``left_out`` says how many
    rows gave none, by reason. ``notes`` are sentences on its clocks, and on what it lacks.
    """

    rows: int
    counts: Mapping[str, int]
    left_out: Mapping[str, int]
    notes: tuple[str, ...] = ()


def write_samples(
    path: Path,
    samples: Iterable[Sample],
    bag_path: str | Path,
    row_counts: Callable[[], tuple[int, Mapping[str, int]]],
) -> Imported:
    """Write the samples of a log as a bag, in the order of time.

    Parameters
    ----------
    path
        The log, which the bag's metadata name.
    samples
        Readings of the log.
    bag_path
        Folder to be made.
    row_counts
        Rows read, and those left out by reason; called once all samples are there.

    Raises
    ------
    LogError
        If there is no sample, or more than `LOG_READINGS`.
    BagError
        If the bag exists or cannot be written.
    """
    new_folder(Path(bag_path), BagError)
    ordered = list(islice(samples, LOG_READINGS.value + 1))
    if len(ordered) > LOG_READINGS.value:
        raise LogError(f'{path}: more than {LOG_READINGS}; expected a log in several files')
    judged = judge_stamps(
        np.array([sample.stamp for sample in ordered], dtype=np.int64), apart_ns=LOG_APART_NS
    )
    ordered = [one for one, false in zip(ordered, judged.false, strict=True) if not false]
    ordered.sort(key=lambda sample: sample.stamp)
    rows, left_out = row_counts()
    if not ordered:
        left_out = {**left_out, **judged.reasons}
        why = f' ({listed(left_out)})' if left_out else ''
        raise LogError(f'{path}: {rows} rows without any reading{why}; expected at least one')
    counts: Counter[str] = Counter()
    with (
        written_folder(Path(bag_path), BagError) as draft,
        BagWriter(draft, custom_data={'log': path.name}) as bag,
    ):
        for sample in ordered:
            topic, message = sample_message(sample)
            bag.write(absolute(topic), message.__msgtype__, serialize(message), sample.stamp)
            counts[absolute(topic)] += 1
    return Imported(rows, counts, left_out, tuple(judged.sentences()))


def listed(left_out: Mapping[str, int]) -> str:
    """List in a line the rows left out, and why."""
    return '; '.join(f'{count}: {reason}' for reason, count in left_out.items())
