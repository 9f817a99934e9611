"""Picture of a tow in the viewer, drawn without a window."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from trawl_ros.core.files import written
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.gear.records import GearRecord
from trawl_ros.view.bags import TowBags
from trawl_ros.view.recording import to_viewer
from trawl_ros.view.rerun_library import ViewerClient
from trawl_ros.view.rerun_log import RerunLog
from trawl_ros.view.viewer import Viewer, ViewerFailed

PATIENCE_S = 90.0
Seen = TypeVar('Seen')

LOOK_S = 1.0
"""Time without a change after which a picture is complete."""


def write_picture(
    tow: TowBags, gear: GearRecord, path: Path, *, on_progress: OnProgress = ignore
) -> None:
    """Draw the tow in the viewer, halfway through its time, as a PNG file.

    Raises
    ------
    ViewerFailed
        If this machine cannot draw it, or this Rerun cannot be asked what it shows.
    """
    if not hasattr(ViewerClient, 'get_state'):
        raise ViewerFailed('a picture needs Rerun 0.41, whose viewer tells what it has drawn')
    with Viewer('headless') as viewer:
        with to_viewer(viewer.url) as recording:
            tow.show(RerunLog(recording, tow.topics), gear, on_progress=on_progress)
        client = ViewerClient(viewer.url)
        begin, end = _still(viewer, lambda: _span(client))
        middle = begin + (end - begin) // 2
        client.set_time('time', duration=middle / 1e9, play_state='paused')
        with written(path) as draft:

            def drawn() -> bytes:
                client.save_screenshot(str(draft))
                return draft.read_bytes()

            _still(viewer, drawn)


def _span(client: ViewerClient) -> tuple[int, int]:
    """Begin and end (ns) of what has arrived in the viewer; both 0 before anything has."""
    lines = [
        line
        for recording in client.get_state().recordings
        for line in recording.timelines
        if line.name == 'time' and line.end is not None
    ]
    return (lines[0].start or 0, lines[0].end) if lines else (0, 0)


def _still(viewer: Viewer, look: Callable[[], Seen]) -> Seen:
    """Return what is seen once it no longer changes, or when patience ends."""
    end = time.monotonic() + PATIENCE_S
    last = look()
    while True:
        time.sleep(LOOK_S)
        viewer.check()
        seen = look()
        if (seen == last and seen != (0, 0)) or time.monotonic() > end:
            return seen
        last = seen
