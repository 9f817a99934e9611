"""Reading of bags for their steady windows, each apart from the others."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from trawl_ros.cli.progress import TimeProgress
from trawl_ros.gear.records import GearRecord
from trawl_ros.identification.bag_windows import BagTask, read_tow
from trawl_ros.identification.tows import FoundWindows

IN_TURN = 2
"""So many bags are read sooner than processes are started for them."""


def read_tows(
    paths: Sequence[Path],
    gear: GearRecord,
    namespace: str,
    console: Console,
    scheduler: str | None = None,
) -> list[FoundWindows]:
    """Find the steady windows of each bag, with a progress display.

    Parameters
    ----------
    paths, gear, namespace
        As in `BagTask`.
    console
        Where to show it.
    scheduler
        Address of a Dask cluster. Without it a few bags are read in turn, more by processes of
        this machine; what is found is the same.
    """
    tasks = [BagTask(path, gear, namespace) for path in paths]
    if scheduler is None and len(tasks) <= IN_TURN:
        return _in_turn(tasks, console)
    return _at_once(tasks, console, scheduler)


def _in_turn(tasks: Sequence[BagTask], console: Console) -> list[FoundWindows]:
    found: list[FoundWindows] = []
    before_s = reached_s = 0.0

    def show(seconds: float, windows: int) -> None:
        nonlocal reached_s
        reached_s = before_s + seconds
        bag = f'bag {len(found) + 1} of {len(tasks)}, ' if len(tasks) > 1 else ''
        windows += sum(len(part.windows) for part in found)
        progress.update(reached_s, f'{bag}{windows} steady windows')

    with TimeProgress('reading', None, console) as progress:
        for task in tasks:
            found.append(read_tow(task, show))
            before_s = reached_s
    return found


def _at_once(
    tasks: Sequence[BagTask], console: Console, scheduler: str | None
) -> list[FoundWindows]:
    # Dask takes a second to import, which a single bag need not wait for.
    from trawl_ros.parallel import run_tasks

    # A bag may be given twice; its place among the others is unique.
    by_name = {f'{number}: {task.path}': task for number, task in enumerate(tasks, start=1)}
    found: dict[str, FoundWindows] = {}
    with Progress(console=console, transient=True) as progress:
        reading = progress.add_task('reading bags', total=len(tasks))
        for name, windows in run_tasks(read_tow, by_name, scheduler=scheduler):
            found[name] = windows
            progress.advance(reading)
    return [found[name] for name in by_name]
