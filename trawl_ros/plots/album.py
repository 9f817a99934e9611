# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a tow, and the page that shows them all."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import empty_folder, made_folder, write_text
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.core.version import __version__
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.water import build_water
from trawl_ros.plots import film
from trawl_ros.plots.gear import gear_figure
from trawl_ros.plots.histories import history_figure, left_out
from trawl_ros.plots.moments import GEAR, IMAGE, MOUTH, Moment, read_moments, read_sweeps
from trawl_ros.plots.reading import read_history
from trawl_ros.plots.records import SonarPicture, TowHistory
from trawl_ros.plots.shapes import gear_shape
from trawl_ros.plots.sonar import sonar_figure
from trawl_ros.plots.track import track_figure
from trawl_ros.records.topics import NAMESPACE
from trawl_ros.report.pictures import Drawing, Picture, by_section, draw
from trawl_ros.report.rendering import page
from trawl_ros.report.style import clock

PAGE = 'index.html'

EARLY_MIDDLE_LATE = (0.05, 0.5, 0.95)
"""Fractions of a tow at which the gear is drawn by default."""

MOST_TIMES = 100


@dataclass(frozen=True)
class DrawnTow:
    """Pictures of a tow as `plot` wrote them.

    Attributes
    ----------
    page
        The HTML page with all of them.
    pictures
        Each with its file next to the page, and its caption.
    notes
        Sentences on what could not be drawn.
    complete
        True if the film, if one was wanted, goes to the end.
    """

    page: Path
    pictures: tuple[Picture, ...]
    notes: tuple[str, ...]
    complete: bool


def plot(
    bag: str | Path,
    out: str | Path,
    *,
    times: Sequence[float] = (),
    animate: bool = False,
    gear: str | Path = 'kaifuha',
    namespace: str = NAMESPACE,
    force: bool = False,
    stopped: Callable[[], bool] = lambda: False,
    on_progress: OnProgress = ignore,
) -> DrawnTow:
    """Draw the tow in a bag: gear, histories of truth and readings, sonar, the ship's track.

    Parameters
    ----------
    bag
        Folder or file.
    out
        Folder for the pictures and the page ``index.html``.
    times
        Times of the pictures of gear and sonar, s after the start of the bag; by default
        early, in the middle and late.
    animate
        True to make a film as well.
    gear
        A file or a name; its water turns pressure into depth.
    namespace
        Of the topics.
    force
        True if pictures of an earlier run in ``out`` are replaced.
    stopped
        Asked between the frames of the film, which ends where it says yes.
    on_progress
        Called as things are read and drawn.

    Returns
    -------
    DrawnTow
        The page, its pictures, and what could not be drawn.

    Raises
    ------
    TrawlError
        If the bag cannot be read, a time is after its end, or ``out`` holds files already or cannot
        be written to.

    Examples
    --------
    >>> import tempfile
    >>> import trawl_ros
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     drawn = trawl_ros.plot('tow_1', folder, times=[600.0])
    >>> [picture.file for picture in drawn.pictures]
    ['history.png', 'gear_00600s.png']
    """
    bag, out = Path(bag), Path(out)
    empty_folder(out, force=force)
    record = load_gear(gear)
    on_progress(WorkProgress('reading'))
    tow = read_history(bag, build_water(record).depth, namespace)
    chosen = _chosen(times, tow)
    made_folder(out)
    album = Album(bag, out, tow, record, namespace)
    on_progress(WorkProgress('drawing'))
    album.histories()
    album.track()
    album.moments(chosen)
    interrupted = animate and album.film(stopped, on_progress)
    write_text(
        out / PAGE,
        page(
            'trawl_ros.plots',
            PAGE,
            name=tow.name,
            duration=clock(tow.duration_s),
            sections=by_section(album.pictures),
            notes=album.notes,
            version=__version__,
        ),
    )
    return DrawnTow(out / PAGE, tuple(album.pictures), tuple(album.notes), not interrupted)


def _chosen(times: Sequence[float], tow: TowHistory) -> list[float]:
    if len(times) > MOST_TIMES:
        raise TrawlError(f'found {len(times)} times, expected at most {MOST_TIMES}')
    for time in times:
        if time > tow.duration_s:
            raise TrawlError(
                f'at {clock(time)}: after the end; expected a time within the '
                f'{clock(tow.duration_s)} of {tow.name}'
            )
    return sorted(set(times)) or [part * tow.duration_s for part in EARLY_MIDDLE_LATE]


class Album:
    """Pictures of one tow, and notes on what could not be drawn."""

    def __init__(
        self, bag: Path, folder: Path, tow: TowHistory, gear: GearRecord, namespace: str
    ) -> None:
        self.pictures: list[Picture] = []
        self.notes = [*tow.problems, *left_out(tow)]
        self._bag, self._folder, self._tow = bag, folder, tow
        self._gear, self._namespace = gear, namespace

    def histories(self) -> None:
        """Draw all quantities over time."""
        self._add(history_figure(self._tow), 'history', 'truth and readings', 'Over time')

    def track(self) -> None:
        """Draw where the ship went."""
        figure = track_figure(self._tow)
        if figure is None:
            self.notes.append(
                "Neither truth/vessel/odom nor vessel/fix: the ship's track is unknown."
            )
        else:
            self._add(figure, 'track', "the ship's track over ground", 'The ship')

    def moments(self, times: Sequence[float]) -> None:
        """Draw the gear, and what the sonar showed, at some times."""
        for moment, picture in self._read(times):
            shape = gear_shape(moment, self._tow, self._gear)
            at, stem = clock(moment.time), f'{moment.time:05.0f}s'
            if shape is None:
                self._note(f'At {at} too little of the gear is known to draw it.')
            else:
                self._add(
                    gear_figure(shape, self._tow.name), f'gear_{stem}',
                    f'the gear at {at} ({shape.source})', 'The gear',
                )  # fmt: skip
            if picture is None:
                self._note(f'No {IMAGE} that could be drawn near {at}.')
            else:
                self._add(
                    sonar_figure(picture, self._tow.name), f'sonar_{stem}',
                    f'the sweep from {clock(picture.time)} on', "The sonar's picture",
                )  # fmt: skip

    def film(self, stopped: Callable[[], bool], on_progress: OnProgress) -> bool:
        """Draw the animation; return whether it was stopped early."""
        frames = []
        for moment, picture in self._read(film.frame_times(self._tow)):
            shape = gear_shape(moment, self._tow, self._gear)
            if shape is not None:
                frames.append(film.Frame(shape, picture))
            if stopped():
                return True
        if not frames:
            self._note('Too little of the gear is known for a film.')
            return False
        interrupted = False

        def go_on(done: int) -> bool:
            nonlocal interrupted
            reached, detail = frames[done - 1].shape.time, f'frame {done} of {len(frames)}'
            on_progress(WorkProgress('filming', reached, self._tow.duration_s, 's', detail))
            interrupted = stopped()
            return not interrupted

        done = film.write_film(self._folder / 'film.gif', self._tow.name, frames, go_on)
        caption = f'the tow in {done} pictures, up to {clock(frames[done - 1].shape.time)}'
        self.pictures.append(Picture('film.gif', caption, 'Film'))
        return interrupted

    def _read(self, times: Sequence[float]) -> Iterator[tuple[Moment, SonarPicture | None]]:
        sweeps, problems = read_sweeps(self._bag, self._tow, times, self._namespace)
        for problem in problems:
            self._note(problem)
        moments = read_moments(self._bag, self._tow, times, self._namespace, [GEAR, MOUTH])
        return zip(moments, sweeps, strict=True)

    def _add(self, figure: Figure, name: str, caption: str, section: str) -> None:
        self.pictures += draw(self._folder, [Drawing(name, caption, figure, section)])

    def _note(self, sentence: str) -> None:
        if sentence not in self.notes:
            self.notes.append(sentence)
