# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Adapter to Rerun: converts records into entities of a recording on one time line."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field

import numpy as np

from trawl_ros.plots.records import Quantities
from trawl_ros.report.style import FAINT, MEASURED, PORT, SECOND
from trawl_ros.view.layout import TIMELINE, Camera, layout
from trawl_ros.view.records import (
    Coefficients,
    Echoes,
    Fix,
    Gear,
    Innovations,
    Note,
    Schools,
    Section,
    SeenSchools,
    ShipPose,
    Shown,
    Sweep,
)
from trawl_ros.view.scenes import LINE, THIN, SeaScene, SonarScreen, from_above
from trawl_ros.view.series import CURVES, HEADING, LEGEND, Line, PanelRanges, Unwrapped, rgb_of
from trawl_ros.view.ship import Track
from trawl_ros.view.viewer.rerun_library import rr

SIMULATED_BEFORE = 15 * 365 * 86_400 * 1_000_000_000
"""Stamps (ns) below this are times since the start of a simulation, not dates."""

BATCH = 20_000
"""Largest number of waiting values of all series; they are passed on together."""


SHIP = (230, 230, 235)


@dataclass
class _Waiting:
    """Values of a series that wait to be passed on."""

    stamps: list[int] = field(default_factory=list)
    values: list[float] = field(default_factory=list)


class RerunLog:
    """Log of a tow in a recording of Rerun.

    Parameters
    ----------
    recording
        The recording, connected to a file or a viewer.
    topics
        Relative names of the topics that there may be: views of others are left out.
    live
        True to follow what comes, with the last minutes in the histories.

    Attributes
    ----------
    count : int
        Records that were shown.
    """

    def __init__(
        self, recording: rr.RecordingStream, topics: Collection[str], *, live: bool = False
    ) -> None:
        self.count = 0
        self._live = live
        self._recording = recording
        self._topics = topics
        self._waiting: dict[str, _Waiting] = {}
        self._waits = 0
        self._styled: set[str] = set()
        self._turns = {kind: Unwrapped() for kind in ('truth', 'measured', 'wanted')}
        self._simulated: bool | None = None
        self._pose: ShipPose | None = None
        self._tracks = {'track': Track(), 'fixes': Track()}
        self._source = ''
        self._screen = SonarScreen(self._at)
        self._sea = SeaScene(self._at)
        self._camera: Camera | None = None
        self._ranges = PanelRanges()
        recording.set_log_time_enabled(False)
        recording.log('/map', rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._lay_out()

    def show(self, record: Shown) -> None:
        """Log a record."""
        self.count += 1
        if self._simulated is None:
            self._simulated = record.stamp < SIMULATED_BEFORE
        match record:
            case Quantities():
                self._quantities(record)
            case ShipPose():
                self._ship(record)
            case Fix():
                self._fix(record)
            case Gear():
                self._gear(record)
            case Schools():
                self._sea.schools(record)
            case SeenSchools():
                self._sea.seen_schools(record)
            case Sweep():
                self._screen.sweep(record)
            case Section():
                self._screen.section(record)
            case Echoes():
                self._sea.echoes(record)
            case Coefficients():
                self._coefficients(record)
            case Innovations():
                self._innovations(record)
            case Note():
                self._note(record)

    def flush(self) -> None:
        """Pass on all waiting values."""
        for path, waiting in self._waiting.items():
            self._recording.send_columns(
                path,
                indexes=[self._column(waiting.stamps)],
                columns=rr.Scalars.columns(scalars=waiting.values),
            )
        self._waiting.clear()
        self._waits = 0

    def finish(self) -> None:
        """Pass on all waiting values, and lay out the views that have data."""
        self.flush()
        self._lay_out(self._ranges.panels)

    def _set_time(self, stamp: int) -> None:
        if self._simulated:
            self._recording.set_time(TIMELINE, duration=np.timedelta64(stamp, 'ns'))
        else:
            self._recording.set_time(TIMELINE, timestamp=np.datetime64(stamp, 'ns'))

    def _column(self, stamps: Sequence[int]) -> rr.TimeColumn:
        times = np.array(stamps, dtype=np.int64)
        if self._simulated:
            return rr.TimeColumn(TIMELINE, duration=times.astype('timedelta64[ns]'))
        return rr.TimeColumn(TIMELINE, timestamp=times.astype('datetime64[ns]'))

    def _at(self, stamp: int, path: str, shown: object) -> None:
        self._set_time(stamp)
        self._log(path, shown)

    def _log(self, path: str | list[str], shown: object) -> None:
        self._recording.log(path, shown)

    def _lay_out(self, panels: Collection[str] | None = None) -> None:
        limits = self._ranges.limits()
        blueprint = layout(self._topics, self._camera, panels, limits, live=self._live)
        self._recording.send_blueprint(blueprint)

    def _value(self, line: Line, stamp: int, value: float) -> None:
        if line.path not in self._styled:
            self._styled.add(line.path)
            styled = (
                rr.SeriesPoints(colors=[line.colour], names=[line.name], marker_sizes=[1.6])
                if line.dots
                else rr.SeriesLines(colors=[line.colour], names=[line.name], widths=[line.width])
            )
            self._recording.log(line.path, styled, static=True)
        waiting = self._waiting.setdefault(line.path, _Waiting())
        waiting.stamps.append(stamp)
        waiting.values.append(value)
        self._waits += 1
        if self._waits >= BATCH:
            self.flush()

    def _quantities(self, record: Quantities) -> None:
        for name, value in record.values.items():
            placed = CURVES.get(name)
            if placed is None or not (np.isfinite(value) or record.kind == 'model'):
                continue
            if name == HEADING:
                value = self._turns[record.kind].take(name, value)
            shown = placed.shown(value)
            self._value(placed.line(record.kind), record.stamp, shown)
            if np.isfinite(shown):
                self._ranges.take(placed.panel, record.kind, shown)
        if record.kind == 'measured':
            self._screen.opening(record)

    def _ship(self, pose: ShipPose) -> None:
        self._pose = pose
        self._set_time(pose.stamp)
        half = 0.5 * pose.heading
        self._log(
            '/map/ship',
            rr.Transform3D(
                translation=pose.position,
                quaternion=rr.Quaternion(xyzw=[0.0, 0.0, np.sin(half), np.cos(half)]),
            ),
        )
        here = from_above(pose.position[None])
        self._log('/top/ship', rr.Points2D(here, colors=[SHIP], radii=[-5.0]))
        track = self._tracks['track'].take(here[0])
        if track is not None:
            self._log('/top/track', rr.LineStrips2D([track], colors=[SHIP], radii=[LINE]))

    def _fix(self, fix: Fix) -> None:
        fixes = self._tracks['fixes'].take(from_above(fix.position[None])[0])
        if fixes is not None:
            self._set_time(fix.stamp)
            self._log('/top/fixes', rr.Points2D(fixes, colors=[rgb_of(MEASURED)], radii=[-2.0]))

    def _gear(self, gear: Gear) -> None:
        self._set_time(gear.stamp)
        if gear.source != self._source:
            if self._source:
                self._log('/map/gear', rr.Clear(recursive=True))
                self._log('/top/gear', rr.Clear(recursive=True))
            else:
                self._camera = self._placed(gear)
                self._lay_out()
                self._note(Note(gear.stamp, 'view', 'INFO', LEGEND))
            self._source = gear.source
            text = f'the gear is drawn from {gear.source}'
            self._note(Note(gear.stamp, 'view', 'INFO', text))
        for strand in gear.strands:
            colours = np.round(255.0 * strand.colours).astype(np.uint8)
            self._log(
                ['map', 'gear', strand.name],
                rr.LineStrips3D(strand.pieces, colors=colours, radii=[LINE]),
            )
            flat = from_above(strand.pieces.reshape(-1, 3)).reshape(-1, 2, 2)
            self._log(
                ['top', 'gear', strand.name],
                rr.LineStrips2D(flat, colors=colours, radii=[THIN]),
            )
        for plate in gear.plates:
            self._log(
                ['map', 'gear', plate.name],
                rr.Boxes3D(
                    centers=[plate.position],
                    half_sizes=[0.5 * plate.size],
                    quaternions=[rr.Quaternion(xyzw=plate.orientation)],
                    colors=[rgb_of(SECOND)],
                    fill_mode='solid',
                ),
            )

    def _placed(self, gear: Gear) -> Camera:
        """Place the camera abeam to starboard, with all of the gear in view."""
        points = np.concatenate([strand.pieces.reshape(-1, 3) for strand in gear.strands])
        low, high = points.min(axis=0), points.max(axis=0)
        pose = self._pose or ShipPose(gear.stamp, np.zeros(3), 0.0)
        middle = 0.5 * (low + high) - pose.position
        length = float(np.linalg.norm(high - low))
        c, s = np.cos(pose.heading), np.sin(pose.heading)
        ahead, port = c * middle[0] + s * middle[1], -s * middle[0] + c * middle[1]
        return Camera((float(ahead), float(port), float(middle[2])), length)

    def _coefficients(self, record: Coefficients) -> None:
        for name, interval in record.intervals.items():
            for what, value in (
                ('value', interval.value),
                ('low', interval.low),
                ('high', interval.high),
            ):
                colour = rgb_of(MEASURED if what == 'value' else FAINT)
                line = Line(f'/estimate/{name}/{what}', f'{name} {what}', colour, dots=False)
                self._value(line, record.stamp, value)
        self._set_time(record.stamp)
        self._log('/estimates', rr.TextDocument(_table(record), media_type='text/markdown'))

    def _innovations(self, record: Innovations) -> None:
        for name, deviation in record.deviations.items():
            colour = rgb_of(PORT) if name.startswith('port') else rgb_of(MEASURED)
            line = Line(f'/innovations/{name}', name, colour, dots=True)
            self._value(line, record.stamp, deviation)

    def _note(self, note: Note) -> None:
        self._set_time(note.stamp)
        self._log(['notes', note.source], rr.TextLog(note.text, level=note.level))


def _table(record: Coefficients) -> str:
    """Table of an estimate in Markdown."""
    rows = [
        f'| {name} | {entry.value:.3f} | {entry.low:.3f} … {entry.high:.3f} | '
        f'{"yes" if entry.determined else "no"} |'
        for name, entry in record.intervals.items()
    ]
    head = ['| coefficient | value | 95 % interval | determined |', '|---|---|---|---|']
    return '\n'.join([f'**{record.windows} windows.** {record.message}', '', *head, *rows])
