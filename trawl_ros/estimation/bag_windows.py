# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Steady windows of bags, each read apart from the others."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from trawl_ros.bags.samples import SampleStream
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.time import SECOND
from trawl_ros.estimation.from_gear import identification_for
from trawl_ros.estimation.tows import FoundWindows
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.records.channels import READ_TOPICS

SAMPLES = 100
"""So many samples are read between two calls that tell of progress."""

IN_TURN = 2
"""So many bags are read sooner than processes are started for them."""

IN_TURN_BYTES = 16_000_000
"""So are bags of so many bytes in all: a process takes as long to start as 4 MB to read."""


@dataclass(frozen=True)
class BagTask:
    """Task of reading a bag: its path, topics, and the gear whose water gives depths."""

    path: Path
    gear: GearRecord
    namespace: str


def read_tow(task: BagTask, on_progress: OnProgress = ignore) -> FoundWindows:
    """Find the steady windows of one bag.

    Parameters
    ----------
    task
        The bag, its topics and its gear.
    on_progress
        Called now and then, with the part of the tow (s) that is read.
    """
    identification = identification_for(task.gear)
    finder = identification.finder
    stream = SampleStream([task.path], task.namespace, topics=READ_TOPICS)
    windows: list[SteadyWindow] = []
    newest: int | None = None
    done = 0
    for number, (_, sample) in enumerate(stream):
        if newest is None or sample.stamp > newest:
            done += 0 if newest is None else sample.stamp - newest
            newest = sample.stamp
        windows += [item for item in finder.feed(sample) if isinstance(item, SteadyWindow)]
        if number % SAMPLES == 0:
            detail = f'{len(windows)} steady windows'
            on_progress(WorkProgress('reading', done / SECOND, None, 's', detail))
    windows += [item for item in finder.finish() if isinstance(item, SteadyWindow)]
    why_not = identification.why_not()
    if identification.missing_channels():
        why_not = (
            f'{why_not}; expected readings on all of these, `trawl bag check` lists the topics'
        )
    return FoundWindows(
        name=str(task.path),
        windows=tuple(windows),
        arrived=finder.arrived,
        readings=finder.readings,
        rejections=finder.rejections,
        why_not=None if windows else why_not,
        problems=tuple(stream.problems),
    )


def read_tows(
    paths: Sequence[Path],
    gear: GearRecord,
    namespace: str,
    *,
    scheduler: str | None = None,
    on_progress: OnProgress = ignore,
) -> list[FoundWindows]:
    """Find the steady windows of each bag.

    Parameters
    ----------
    paths, gear, namespace
        As in `BagTask`.
    scheduler
        Address of a Dask cluster. Without it few or small bags are read in turn, more by processes
        of this machine; what is found is the same.
    on_progress
        Called as bags are read.

    Raises
    ------
    BagError
        If a bag cannot be read at all.
    """
    tasks = [BagTask(path, gear, namespace) for path in paths]
    few = len(tasks) <= IN_TURN or sum(map(_size, paths)) <= IN_TURN_BYTES
    if scheduler is None and few:
        return _in_turn(tasks, on_progress)
    return _at_once(tasks, scheduler, on_progress)


def _size(path: Path) -> int:
    """Bytes of a bag; 0 where they cannot be told, which reading it will."""
    try:
        files = path.iterdir() if path.is_dir() else (path,)
        return sum(file.stat().st_size for file in files if file.is_file())
    except OSError:
        return 0


def _in_turn(tasks: Sequence[BagTask], on_progress: OnProgress) -> list[FoundWindows]:
    recordings: list[FoundWindows] = []
    before_s = reached_s = 0.0

    def show(progress: WorkProgress) -> None:
        nonlocal reached_s
        reached_s = before_s + progress.done
        bag = f'bag {len(recordings) + 1} of {len(tasks)}, ' if len(tasks) > 1 else ''
        on_progress(replace(progress, done=reached_s, detail=f'{bag}{progress.detail}'))

    for task in tasks:
        recordings.append(read_tow(task, show))
        before_s = reached_s
    return recordings


def _at_once(
    tasks: Sequence[BagTask], scheduler: str | None, on_progress: OnProgress
) -> list[FoundWindows]:
    # Dask takes a second to import, which a single bag need not wait for.
    from trawl_ros.core.parallel import run_tasks

    # A bag may be given twice; its place among the others is unique.
    by_name = {f'{number}: {task.path}': task for number, task in enumerate(tasks, start=1)}
    recordings: dict[str, FoundWindows] = {}
    for name, windows in run_tasks(read_tow, by_name, scheduler=scheduler):
        recordings[name] = windows
        on_progress(WorkProgress('reading', len(recordings), len(tasks), 'bags'))
    return [recordings[name] for name in by_name]
