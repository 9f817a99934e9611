# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Comparison of logs with a gear file as it is, and of two bags."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Literal

import numpy as np

from trawl_ros.comparison.comparison import ComparedCourse, Comparison
from trawl_ros.comparison.reading import ReadLog, read_log
from trawl_ros.comparison.rows import Rows
from trawl_ros.comparison.summary import sensors_of, states_of
from trawl_ros.comparison.verdict import verdict_on
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.display_units import METRIC, DisplayUnits
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.core.resources import bag_name, packaged_bag
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.topics import NAMESPACE

if TYPE_CHECKING:
    from trawl_ros.comparison.between_bags import Alignment


def compare(
    logs: Sequence[str | Path],
    *,
    gear: str | Path | GearRecord = 'kaifuha',
    mapping: str | Path | None = None,
    out: str | Path | None = None,
    namespace: str = NAMESPACE,
    units: DisplayUnits = METRIC,
    force: bool = False,
    on_note: Callable[[str], None] = lambda sentence: None,
    on_progress: OnProgress = ignore,
) -> Comparison:
    """Compare logs with a gear file as it is; nothing is fitted.

    Parameters
    ----------
    logs
        Bags, or with ``mapping`` logs, one per tow.
    gear
        Gear: record, file or name.
    mapping
        Mapping file of the logs, as of `import_log`.
    out
        Folder for the page, JSON and figures; nothing is written without it.
    namespace
        Namespace of the topics of a bag.
    units
        Units of the page and of sentences; the record itself is in SI units.
    force
        True to replace results of an earlier run in ``out``.
    on_note, on_progress
        Functions called with sentences on damaged or unused input, and with the progress.

    Returns
    -------
    Comparison
        ``sensors`` over all states, ``states``, ``courses`` over time, ``verdict`` and
        ``next_step``.

    Raises
    ------
    TrawlError
        If no log has a steady state, the gear has no equilibrium in any of them, or ``out``
        contains files.

    Examples
    --------
    >>> import trawl_ros
    >>> found = trawl_ros.compare(['tow_1'], gear='coarse.yaml')
    >>> found.verdict.agrees, len(found.states)
    (True, 2)
    """
    from trawl_ros.comparison.against_gear import against_gear

    if out is not None:
        empty_folder(Path(out), force=force)
    record = gear if isinstance(gear, GearRecord) else load_gear(gear)
    with _bags(logs, mapping) as paths:
        read = [read_log(path, record, namespace, on_progress) for path in paths]
    _note(read, on_note)
    if not any(one.found.windows for one in read):
        raise TrawlError('; '.join(f'{one.found.name}: {one.found.why_not}' for one in read))
    found = against_gear(read, record, on_progress)
    courses = tuple(
        ComparedCourse(_hours(log), log.course.values, equilibria)
        for log, equilibria in zip(read, found.courses, strict=True)
    )
    result = _result(found.rows, 'the gear file says', units, courses)
    name = record.name if isinstance(gear, GearRecord) else str(gear)
    result = replace(result, logs=tuple(map(bag_name, logs)), gear=name, notes=found.notes)
    return _written(result, out, units)


def compare_bags(
    first: str | Path,
    second: str | Path,
    *,
    by: Literal['state', 'time'] = 'state',
    alignment: 'Alignment | None' = None,
    gear: str | Path | GearRecord = 'kaifuha',
    out: str | Path | None = None,
    namespace: str = NAMESPACE,
    units: DisplayUnits = METRIC,
    force: bool = False,
    on_note: Callable[[str], None] = lambda sentence: None,
    on_progress: OnProgress = ignore,
) -> Comparison:
    """Compare two bags, measured or simulated.

    Parameters
    ----------
    first, second
        The bags. Differences are those of the first from the second.
    by
        ``state`` to pair steady states of equal warp and speed, ``time`` to compare stretches.
    alignment
        Tolerances and shift in time.
    gear
        Gear whose water turns pressures into depths.
    out, namespace, units, force, on_note, on_progress
        As in `compare`.

    Returns
    -------
    Comparison
        As of `compare`, with the second bag in place of the prediction, and warp lengths and speed
        among the sensors.

    Raises
    ------
    TrawlError
        If there is nothing in common, or ``out`` contains files.
    """
    from trawl_ros.comparison.between_bags import Alignment, by_state, by_time, on_minutes_of

    if out is not None:
        empty_folder(Path(out), force=force)
    record = gear if isinstance(gear, GearRecord) else load_gear(gear)
    read = [
        read_log(packaged_bag(path), record, namespace, on_progress) for path in (first, second)
    ]
    one, other = read
    _note(read, on_note)
    options = alignment or Alignment()
    moved = on_minutes_of(one.course, other.course, options)
    if by == 'state':
        rows = by_state(one, other, options)
    else:
        rows = by_time(one.course, moved, options)
    names = one.found.name, other.found.name
    if names[0] == names[1]:
        names = '/'.join(Path(first).parts[-2:]), '/'.join(Path(second).parts[-2:])
    course = ComparedCourse(_hours(one), one.course.values, moved.values)
    words = 'states' if by == 'state' else 'stretches'
    result = _result(rows, f'{names[1]} has', units, (course,), words)
    result = replace(result, kind='bags', logs=(bag_name(first), bag_name(second)), names=names)
    return _written(result, out, units)


def _result(
    rows: Rows,
    than: str,
    units: DisplayUnits,
    courses: tuple[ComparedCourse, ...],
    words: str = 'states',
) -> Comparison:
    """Summarise and judge rows."""
    states = states_of(rows)
    sensors, summary = sensors_of(rows, states)
    verdict = verdict_on(sensors, summary, than, units, words)
    return Comparison(sensors, states, courses, verdict)


@contextmanager
def _bags(logs: Sequence[str | Path], mapping: str | Path | None) -> Iterator[list[Path]]:
    """Yield paths of bags, those of imported logs in a folder that lasts as long."""
    if mapping is None:
        yield [packaged_bag(log) for log in logs]
        return
    # Readers of tables load slowly.
    from trawl_ros.bags.logs.import_log import import_log

    with TemporaryDirectory() as folder:
        bags = [Path(folder) / f'{number}' / Path(log).name for number, log in enumerate(logs)]
        for log, bag in zip(logs, bags, strict=True):
            import_log(log, mapping, bag)
        yield bags


def _note(logs: Sequence[ReadLog], on_note: Callable[[str], None]) -> None:
    for log in logs:
        for problem in log.found.problems:
            on_note(f'Damaged: {problem}')
        if log.found.why_not is not None:
            on_note(f'No steady state: {log.found.name}: {log.found.why_not}')


def _hours(log: ReadLog) -> FloatArray:
    return np.arange(0.5, log.course.minutes) / 60.0


def _written(result: Comparison, out: str | Path | None, units: DisplayUnits) -> Comparison:
    if out is not None:
        from trawl_ros.comparison.page import write_comparison

        write_comparison(result, Path(out), units)
    return result
