"""Steady windows of one bag."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from trawl_ros.bags.samples import SampleStream
from trawl_ros.gear.records import GearRecord
from trawl_ros.identification.from_gear import identification_for
from trawl_ros.identification.tows import FoundWindows
from trawl_ros.identification.window_records import SteadyWindow
from trawl_ros.messages.stamps import SECOND


@dataclass(frozen=True)
class BagTask:
    """Task of reading a bag: its path, topics, and the gear whose water gives depths."""

    path: Path
    gear: GearRecord
    namespace: str


def read_tow(task: BagTask, read: Callable[[float, int], None] | None = None) -> FoundWindows:
    """Find the steady windows of one bag.

    Parameters
    ----------
    task
        Which bag.
    read
        Told how much of the tow (s) is read, and how many windows were in it.
    """
    identification = identification_for(task.gear)
    finder = identification.finder
    stream = SampleStream([task.path], task.namespace)
    windows: list[SteadyWindow] = []
    newest: int | None = None
    done = 0
    for _, sample in stream:
        done += 0 if newest is None else max(0, sample.stamp - newest)
        newest = sample.stamp if newest is None else max(newest, sample.stamp)
        windows += [item for item in finder.feed(sample) if isinstance(item, SteadyWindow)]
        if read is not None:
            read(done / SECOND, len(windows))
    windows += [item for item in finder.finish() if isinstance(item, SteadyWindow)]
    return FoundWindows(
        name=str(task.path),
        windows=tuple(windows),
        arrived=finder.arrived,
        readings=finder.readings,
        rejections=finder.rejections,
        why_not=None if windows else identification.why_not(),
        problems=tuple(stream.problems),
    )
