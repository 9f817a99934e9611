# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Animation of a tow: the gear from above and from the side, and the sonar's picture."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.artist import Artist

from trawl_ros.core.files import written
from trawl_ros.plots import gear, sonar
from trawl_ros.plots.records import GearShape, SonarPicture, TowHistory
from trawl_ros.report import style

MOST_FRAMES = 100
"""Largest number of frames: those of 0.8 m pixels stay in memory until the film is written."""

LEAST_APART_S = 1.0
FRAMES_PER_S = 10
DPI = 75
"""Resolution: a film is about 800 pixels wide and has some MB."""


@dataclass(frozen=True)
class Frame:
    """Frame of the animation."""

    shape: GearShape
    picture: SonarPicture | None


def frame_times(tow: TowHistory) -> list[float]:
    """Times (s) of the frames, evenly from the start to the end."""
    frames = int(np.clip(tow.duration_s / LEAST_APART_S + 1, 1, MOST_FRAMES))
    return [float(time) for time in np.linspace(0.0, tow.duration_s, frames)]


def write_film(path: Path, name: str, frames: Sequence[Frame], go_on: Callable[[int], bool]) -> int:
    """Write frames as an animated GIF, which every browser shows.

    Parameters
    ----------
    path
        The file.
    name
        Of the tow, for the title.
    frames
        At least one.
    go_on
        Asked after each frame with the number drawn; where it says no, the film ends there.

    Returns
    -------
    int
        Number of frames drawn.
    """
    shapes = [frame.shape for frame in frames]
    views = gear.lay_out(gear.extent(shapes), width=6.0, right=2.7)
    first = next((frame.picture for frame in frames if frame.picture is not None), None)
    if first is not None:
        sonar.prepare(views.right, first)
        views.right.set_title('sonar', fontsize='medium')
    else:
        gear.prepare_rear(views.right, gear.extent(shapes, rear=True))
    title = views.figure.suptitle('', parse_math=False)
    writer = PillowWriter(fps=FRAMES_PER_S)
    done = 0
    with written(path) as draft, writer.saving(views.figure, str(draft), DPI):
        for frame in frames:
            title.set_text(f'{name} at {style.clock(frame.shape.time)}: {frame.shape.source}')
            drawn = _draw(views, frame, with_sonar=first is not None)
            writer.grab_frame()
            for artist in drawn:
                artist.remove()
            done += 1
            if not go_on(done):
                break
    return done


def _draw(views: gear.Views, frame: Frame, *, with_sonar: bool) -> list[Artist]:
    drawn = [
        *gear.draw_gear(frame.shape, views.top, gear.ABOVE),
        *gear.draw_gear(frame.shape, views.side, gear.BESIDE),
        *gear.write_sizes(frame.shape, views),
    ]
    if not with_sonar:
        drawn += gear.draw_gear(frame.shape, views.right, gear.BEHIND)
    elif frame.picture is not None:
        # At this size the marks of truth would hide the echoes.
        drawn += sonar.draw_sonar(
            views.right, replace(frame.picture, mouth=frame.picture.mouth[:0])
        )
    return drawn
