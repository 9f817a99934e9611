# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Tows read in parallel, and brought together in one estimate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.windows.records import Rejections, SteadyWindow


@dataclass(frozen=True)
class FoundWindows:
    """Windows found in one recording.

    Attributes
    ----------
    name
        Of the recording, for people.
    windows
        Its steady windows, whose indices, states and tows count from 0.
    arrived, readings
        Channel → readings that came, and those of them that were accepted.
    rejections
        Refused readings and windows.
    why_not
        Reason for the lack of windows, in a sentence; None with windows.
    problems
        A sentence for each thing that was damaged.
    """

    name: str
    windows: tuple[SteadyWindow, ...]
    arrived: Mapping[str, int]
    readings: Mapping[str, int]
    rejections: Rejections
    why_not: str | None
    problems: tuple[str, ...]


def require_distinct(recordings: Sequence[FoundWindows]) -> None:
    """Refuse a recording that is given twice: its evidence would count twice.

    Raises
    ------
    TrawlError
        If all steady windows of two are the same.
    """
    for number, one in enumerate(recordings):
        for other in recordings[:number]:
            if one.windows and one.windows == other.windows:
                raise TrawlError(
                    f'{other.name} and {one.name} hold the same {len(one.windows)} steady windows; '
                    'expected each tow once, as a baseline or to be examined'
                )


def numbered(recordings: Sequence[FoundWindows]) -> tuple[list[SteadyWindow], list[str]]:
    """Number windows, states and tows consecutively over all recordings.

    Returns
    -------
    list
        All windows, recording after recording.
    list
        The name of each tow: that of its recording, with a number where this holds several.
    """
    windows: list[SteadyWindow] = []
    names: list[str] = []
    states = 0
    for recording in recordings:
        first = len(names)
        tows = 1 + max((window.tow for window in recording.windows), default=-1)
        base = len(windows)
        windows += [
            replace(
                window,
                index=base + window.index,
                state=states + window.state,
                tow=first + window.tow,
            )
            for window in recording.windows
        ]
        states += 1 + max((window.state for window in recording.windows), default=-1)
        name = recording.name
        names += [name] if tows == 1 else [f'{name}, tow {i + 1}' for i in range(tows)]
    return windows, names


def estimate_tows(
    identification: Identification,
    recordings: Sequence[FoundWindows],
    on_progress: OnProgress = ignore,
) -> list[str]:
    """Use the windows of several recordings, as if one finder had found them one after another.

    Parameters
    ----------
    identification
        To which nothing was fed yet; brought to rest afterwards.
    recordings
        In the order in which they count.
    on_progress
        Called after each window.

    Returns
    -------
    list
        The name of each tow.
    """
    windows, names = numbered(recordings)
    finder = identification.finder
    for recording in recordings:
        finder.arrived.update(recording.arrived)
        finder.readings.update(recording.readings)
        finder.rejections.counts.update(recording.rejections.counts)
        finder.rejections.sentences.update(recording.rejections.sentences)
    for number, window in enumerate(windows, start=1):
        identification.take([window])
        on_progress(WorkProgress('fitting', number, len(windows), 'windows'))
    identification.estimator.finish()
    return names
