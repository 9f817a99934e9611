# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Picture of a tow in the viewer, drawn without a window."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from trawl_ros.core.files import written
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.gear.records import GearRecord
from trawl_ros.view.bags import TowBags
from trawl_ros.view.layout import TIMELINE
from trawl_ros.view.recording import to_viewer
from trawl_ros.view.rerun_log import RerunLog
from trawl_ros.view.viewer.process import ViewerFailed
from trawl_ros.view.viewer.rerun_library import ViewerClient
from trawl_ros.view.viewer.viewer import Viewer

PATIENCE_S = 90.0
Seen = TypeVar('Seen')

LOOK_S = 1.0
"""Time without a change after which a picture is complete."""


def write_picture(
    tow: TowBags,
    gear: GearRecord,
    path: Path,
    *,
    model: bool = False,
    on_progress: OnProgress = ignore,
) -> None:
    """Draw the tow in the viewer, halfway through its time, as a PNG file.

    Raises
    ------
    ViewerFailed
        If this machine cannot draw it, or this Rerun cannot be asked what it shows.
    """
    if not hasattr(ViewerClient, 'get_state'):
        raise ViewerFailed('a picture needs Rerun 0.41, whose viewer reports what it has drawn')
    with Viewer('headless') as viewer:
        with to_viewer(viewer.url) as recording:
            log = RerunLog(recording, tow.topics)
            tow.show(log, gear, model=model, on_progress=on_progress)
        client = ViewerClient(viewer.url)
        line = _still(viewer, lambda: _line(client))
        if line is None:
            raise ViewerFailed(f'the viewer has shown nothing of the tow in {PATIENCE_S:.0f} s')
        _still(viewer, lambda: _stopped(client, line))
        with written(path) as draft:

            def drawn() -> bytes:
                client.save_screenshot(str(draft))
                return draft.read_bytes()

            if _still(viewer, drawn) is None:
                raise ViewerFailed(f'the viewer has drawn nothing in {PATIENCE_S:.0f} s')


def _line(client: ViewerClient) -> Any | None:
    """Time line that has arrived in the viewer; None before anything has."""
    lines = [
        line
        for recording in client.get_state().recordings
        for line in recording.timelines
        if line.name == TIMELINE and line.end is not None
    ]
    return lines[0] if lines else None


def _stopped(client: ViewerClient, line: Any) -> bool:
    """Stop halfway: at a time since the start of a simulation, or at a time of day."""
    middle = (line.start + line.end) // 2
    if line.time_type == 'timestamp':
        client.set_time(TIMELINE, timestamp=np.datetime64(middle, 'ns'), play_state='paused')
    else:
        client.set_time(TIMELINE, duration=np.timedelta64(middle, 'ns'), play_state='paused')
    return True


def _still(viewer: Viewer, look: Callable[[], Seen | None]) -> Seen | None:
    """Return the picture once it no longer changes, or after the time limit."""
    end = time.monotonic() + PATIENCE_S
    last = None
    while True:
        viewer.check()
        seen = _seen(look)
        if (seen is not None and seen == last) or time.monotonic() > end:
            return seen or last
        last = seen or last
        time.sleep(LOOK_S)


def _seen(look: Callable[[], Seen | None]) -> Seen | None:
    """Return the current picture; None if the viewer is busy drawing."""
    try:
        return look()
    except OSError:
        return None
