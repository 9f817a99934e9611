"""``trawl plot``."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import click
from matplotlib.figure import Figure
from rich.console import Console

from trawl_ros.cli.files import BAG, FOLDER
from trawl_ros.cli.interruption import INTERRUPTED, Interruption
from trawl_ros.cli.progress import TimeProgress, error_console
from trawl_ros.errors import TrawlError
from trawl_ros.files import empty_folder, write_figure
from trawl_ros.gear.load import load_gear
from trawl_ros.gear.records import GearRecord
from trawl_ros.messages.topics import NAMESPACE
from trawl_ros.model.gear_model import build_water
from trawl_ros.plots import film
from trawl_ros.plots.gear import gear_figure
from trawl_ros.plots.histories import history_figure, left_out
from trawl_ros.plots.moments import GEAR, IMAGE, MOUTH, Moment, read_moments
from trawl_ros.plots.page import PAGE, Picture, write_page
from trawl_ros.plots.reading import read_tow
from trawl_ros.plots.records import SonarPicture, Tow
from trawl_ros.plots.shapes import gear_shape
from trawl_ros.plots.sonar import sonar_figure
from trawl_ros.plots.style import DPI, clock
from trawl_ros.plots.sweeps import read_sweeps
from trawl_ros.plots.track import track_figure

EARLY_MIDDLE_LATE = (0.05, 0.5, 0.95)
"""Parts of a tow at which the gear is drawn unless told otherwise."""

MOST_TIMES = 100


class _Time(click.ParamType[float]):
    """Parameter type: a time after the start, ``90``, ``1:30`` or ``0:01:30``, as seconds."""

    name = 'time'

    def convert(
        self, value: str | float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        if isinstance(value, str) and re.fullmatch(r'(\d+:){0,2}\d+(\.\d+)?', value):
            parts = [float(part) for part in reversed(value.split(':'))]
            return sum(part * 60.0**k for k, part in enumerate(parts))
        self.fail(f'found {value!r}, expected seconds, minutes:seconds or hours:minutes:seconds')


@click.command('plot')
@click.argument('bag', type=BAG)
@click.option('--out', required=True, type=FOLDER, help='Folder for the pictures.')
@click.option(
    '--at', 'times', multiple=True, type=_Time(), metavar='TIME', help='When to draw the gear and '
    "the sonar's picture, after the start of the bag: 90, 1:30 or 1:02:30. May be given again; "
    'by default early, in the middle and late.',
)  # fmt: skip
@click.option('--animate', is_flag=True, help='Make a short film as well.')
@click.option(
    '--gear', default='kaifuha', show_default=True, help='The gear: a file or the name of one that '
    'comes with the package. Its water turns pressure into depth.',
)  # fmt: skip
@click.option('--namespace', default=NAMESPACE, show_default=True, help='Of the topics.')
@click.option('--force', is_flag=True, help='Replace the pictures of an earlier run in --out.')
def command(
    bag: Path,
    out: Path,
    times: Sequence[float],
    animate: bool,
    gear: str,
    namespace: str,
    force: bool,
) -> None:
    """Draw the tow in BAG: the gear, what was true and measured, the sonar, the ship's track.

    Leaves pictures and a page with all of them in a folder.
    """
    empty_folder(out, force=force)
    record = load_gear(gear)
    console = error_console()
    with console.status('reading'):
        tow = read_tow(bag, build_water(record).depth, namespace)
    chosen = _chosen(times, tow)
    out.mkdir(parents=True, exist_ok=True)
    album = _Album(bag, out, tow, record, namespace)
    with console.status('drawing'):
        album.histories()
        album.track()
        album.moments(chosen)
    interrupted = animate and album.film(console)
    write_page(out, tow, album.pictures, album.notes)
    for picture in album.pictures:
        click.echo(f'{out / picture.file}: {picture.caption}')
    for note in album.notes:
        click.echo(note)
    click.echo(f'{out / PAGE}: all of them on a page')
    if interrupted:
        raise SystemExit(INTERRUPTED)


def _chosen(times: Sequence[float], tow: Tow) -> list[float]:
    if len(times) > MOST_TIMES:
        raise TrawlError(f'--at: found {len(times)} times, expected at most {MOST_TIMES}')
    for time in times:
        if time > tow.duration_s:
            raise TrawlError(
                f'--at {clock(time)}: after the end; expected a time within the '
                f'{clock(tow.duration_s)} of {tow.name}'
            )
    return sorted(set(times)) or [part * tow.duration_s for part in EARLY_MIDDLE_LATE]


class _Album:
    """Album of one tow's figures, and notes on those that could not be drawn."""

    def __init__(self, bag: Path, folder: Path, tow: Tow, gear: GearRecord, namespace: str) -> None:
        self.pictures: list[Picture] = []
        self.notes = [*tow.problems, *left_out(tow)]
        self._bag, self._folder, self._tow = bag, folder, tow
        self._gear, self._namespace = gear, namespace

    def histories(self) -> None:
        """Draw all quantities over time."""
        self._add(history_figure(self._tow), 'history.png', 'truth and readings', 'Over time')

    def track(self) -> None:
        """Draw the ship's track."""
        figure = track_figure(self._tow)
        if figure is None:
            self.notes.append(
                "Neither truth/vessel/odom nor vessel/fix: the ship's track is unknown."
            )
        else:
            self._add(figure, 'track.png', "the ship's track over ground", 'The ship')

    def moments(self, times: Sequence[float]) -> None:
        """Draw the gear and the sonar's sweep at some times."""
        for moment, picture in self._read(times):
            shape = gear_shape(moment, self._tow, self._gear)
            at, stem = clock(moment.time), f'{moment.time:05.0f}s'
            if shape is None:
                self._note(f'At {at} too little of the gear is known to draw it.')
            else:
                self._add(
                    gear_figure(shape, self._tow.name), f'gear_{stem}.png',
                    f'the gear at {at} ({shape.source})', 'The gear',
                )  # fmt: skip
            if picture is None:
                self._note(f'No {IMAGE} that could be drawn near {at}.')
            else:
                self._add(
                    sonar_figure(picture, self._tow.name), f'sonar_{stem}.png',
                    f'the sweep from {clock(picture.time)} on', "The sonar's picture",
                )  # fmt: skip

    def film(self, console: Console) -> bool:
        """Draw the film; return True if it was interrupted and ends early."""
        with (
            TimeProgress('filming', self._tow.duration_s, console) as progress,
            Interruption() as interruption,
        ):
            frames = []
            for moment, picture in self._read(film.frame_times(self._tow)):
                shape = gear_shape(moment, self._tow, self._gear)
                if shape is not None:
                    frames.append(film.Frame(shape, picture))
                if interruption.requested:
                    return True
            if not frames:
                self._note('Too little of the gear is known for a film.')
                return False

            def go_on(done: int) -> bool:
                progress.update(frames[done - 1].shape.time, f'frame {done} of {len(frames)}')
                return not interruption.requested

            done = film.write_film(self._folder / 'film.gif', self._tow.name, frames, go_on)
            caption = f'the tow in {done} pictures, up to {clock(frames[done - 1].shape.time)}'
            self.pictures.append(Picture('film.gif', caption, 'Film'))
            return interruption.requested

    def _read(self, times: Sequence[float]) -> Iterator[tuple[Moment, SonarPicture | None]]:
        sweeps, problems = read_sweeps(self._bag, self._tow, times, self._namespace)
        for problem in problems:
            self._note(problem)
        moments = read_moments(self._bag, self._tow, times, self._namespace, [GEAR, MOUTH])
        return zip(moments, sweeps, strict=True)

    def _add(self, figure: Figure, file: str, caption: str, section: str) -> None:
        write_figure(self._folder / file, figure, DPI)
        self.pictures.append(Picture(file, caption, section))

    def _note(self, sentence: str) -> None:
        if sentence not in self.notes:
            self.notes.append(sentence)
