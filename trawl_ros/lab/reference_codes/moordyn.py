# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""MoorDyn: its input file, and a running system."""

import ctypes
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.absent import PeerFailed, peer

WATER_DEPTH_M = 3000.0
"""Water depth (m) at which nothing touches the bottom."""


@dataclass(frozen=True)
class LineType:
    """Line type, in MoorDyn's terms.

    ``diameter`` (m) of the displaced volume; ``mass`` in air (kg/m); ``stiffness`` EA (N);
    ``damping`` BA (N s), or a negative share of critical damping; drag across on the diameter,
    along on π d; added mass across and along as shares of the displaced mass.
    """

    diameter: float
    mass: float
    stiffness: float
    damping: float
    drag: float
    added: float
    drag_along: float
    added_along: float = 0.0


@dataclass(frozen=True)
class Point:
    """Point: ``coupled`` ones are moved from outside, ``free`` ones by forces.

    ``place`` (3,) in m with z up from the surface, ``mass`` kg, ``volume`` m³, ``drag_area``
    C_D A in m², ``added`` mass as a share of the displaced mass.
    """

    kind: Literal['coupled', 'free']
    place: Sequence[float]
    mass: float = 0.0
    volume: float = 0.0
    drag_area: float = 0.0
    added: float = 0.0


@dataclass(frozen=True)
class Line:
    """Line between two points.

    Attributes
    ----------
    kind
        Index of its line type, from 0.
    start, end
        Indices of its points, from 0.
    length
        Unstretched length, m.
    segments
        Number of segments.
    """

    kind: int
    start: int
    end: int
    length: float
    segments: int


@dataclass(frozen=True)
class Options:
    """Solver options of MoorDyn, and the water.

    Attributes
    ----------
    scheme
        MoorDyn's name of the time scheme.
    step
        Time step, s.
    density, gravity
        In kg/m³ and m/s².
    """

    scheme: str
    step: float
    density: float = 1025.0
    gravity: float = 9.80665


def input_file(
    kinds: Sequence[LineType], points: Sequence[Point], lines: Sequence[Line], options: Options
) -> str:
    """Return the text of an input file (version 2)."""
    return '\n'.join(
        [
            '--- MoorDyn ---',
            '--- LINE TYPES ---',
            'Name Diam Mass EA BA EI Cd Ca CdAx CaAx',
            '(-) (m) (kg/m) (N) (N-s) (N-m2) (-) (-) (-) (-)',
            *(
                f'kind{k} {t.diameter!r} {t.mass!r} {t.stiffness!r} {t.damping!r} 0 {t.drag!r} '
                f'{t.added!r} {t.drag_along!r} {t.added_along!r}'
                for k, t in enumerate(kinds)
            ),
            '--- POINTS ---',
            'ID Type X Y Z Mass Volume CdA Ca',
            '(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)',
            *(
                f'{k} {p.kind} {" ".join(f"{float(x)!r}" for x in p.place)} {p.mass!r} '
                f'{p.volume!r} {p.drag_area!r} {p.added!r}'
                for k, p in enumerate(points, 1)
            ),
            '--- LINES ---',
            'ID Kind EndA EndB Length Segments Outputs',
            '(-) (-) (-) (-) (m) (-) (-)',
            *(
                f'{k} kind{n.kind} {n.start + 1} {n.end + 1} {n.length!r} {n.segments} -'
                for k, n in enumerate(lines, 1)
            ),
            '--- OPTIONS ---',
            '0 writeLog',
            f'{options.step!r} dtM',
            f'{options.scheme} tScheme',
            f'{options.density!r} rho',
            f'{options.gravity!r} g',
            f'{WATER_DEPTH_M!r} WtrDpth',
            '1 disableOutput',
            '1 disableOutTime',
            '--- END ---',
            '',
        ]
    )


STATE_HEADER_BYTES = 9
"""Bytes of a file of MoorDyn's state before its numbers: a name and a version."""


class MoorDyn:
    """System of lines and points; close it, or use it in a ``with`` statement.

    Parameters
    ----------
    text
        The input file, from `input_file`.
    places, velocities
        (c, 3) of the coupled points in their order, m and m/s.

    Raises
    ------
    PeerAbsent
        If MoorDyn is not installed.
    PeerFailed
        If MoorDyn does not take the input.
    """

    def __init__(self, text: str, places: FloatArray, velocities: FloatArray) -> None:
        self._module: Any = peer('moordyn')
        self._system: Any = None
        self._folder = TemporaryDirectory(prefix='moordyn_')
        file = Path(self._folder.name) / 'lines.txt'
        file.write_text(text)
        with silence():
            self._system = self._module.Create(str(file))
            self._module.SetVerbosity(self._system, self._module.LEVEL_NONE)
            code = self._module.Init_NoIC(self._system, places.ravel(), velocities.ravel())
        if code != self._module.ERRCODE_SUCCESS:
            self.close()
            raise PeerFailed(f'MoorDyn did not start: code {code}')
        self._points: dict[int, Any] = {}
        self._lines: dict[int, Any] = {}

    def step(
        self, places: FloatArray, velocities: FloatArray, time: float, step: float
    ) -> FloatArray:
        """Advance by ``step`` seconds from ``time``, and return the forces on the coupled points.

        The coupled points start at ``places`` (c, 3) and move with ``velocities`` (c, 3)
        throughout. The forces (c, 3), in N, are those at the end of the step.

        Raises
        ------
        PeerFailed
            If MoorDyn's own stepping breaks down.
        """
        try:
            force = self._module.Step(self._system, places.ravel(), velocities.ravel(), time, step)
        except RuntimeError as error:
            raise PeerFailed(f'MoorDyn broke down at {time:.2f} s: {error}') from None
        return np.reshape(force, (-1, 3))

    def restart(self, places: FloatArray, velocities: FloatArray) -> None:
        """Set the places (p, 3), in m, and the velocities (p, 3), in m/s, of all points.

        Coupled points stay where they are. For lines of one segment this is the whole state.
        """
        file = Path(self._folder.name) / 'state'
        self._module.SaveState(self._system, str(file))
        content = bytearray(file.read_bytes())
        # A header, the number of words and of things, then each thing, points first: rows,
        # columns, and a row of place and velocity.
        words = np.frombuffer(content, '<f8', offset=STATE_HEADER_BYTES)
        rows = words[2 : 2 + 8 * len(places)].reshape(-1, 8)
        rows[:, 2:5], rows[:, 5:8] = places, velocities
        file.write_bytes(content)
        self._module.LoadState(self._system, str(file))

    def place(self, point: int) -> FloatArray:
        """Position of a point (from 0), (3,) m."""
        if point not in self._points:
            self._points[point] = self._module.GetPoint(self._system, point + 1)
        return np.array(self._module.GetPointPos(self._points[point]))

    def length(self, line: int) -> float:
        """Unstretched length of a line (from 0), m."""
        return float(self._module.GetLineUnstretchedLength(self._line(line)))

    def wind(self, line: int, rate: float) -> None:
        """Set the rate of change (m/s) of the unstretched length of a line (from 0)."""
        self._module.SetLineUnstretchedLengthVel(self._line(line), rate)
        # MoorDyn 2.7 gives back None without taking a reference to it, and before Python 3.12
        # the process dies when the last one is gone; this puts the reference back.
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(None))

    def _line(self, line: int) -> Any:
        if line not in self._lines:
            self._lines[line] = self._module.GetLine(self._system, line + 1)
        return self._lines[line]

    def close(self) -> None:
        """End MoorDyn and remove its files."""
        if self._system is not None:
            with silence():
                self._module.Close(self._system)
            self._system = None
        self._folder.cleanup()

    def __enter__(self) -> 'MoorDyn':
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@contextmanager
def silence() -> Iterator[None]:
    """Silence the output of a compiled library.

    It writes to the file descriptors, past ``sys.stdout``, and has no setting for its banner.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(number) for number in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in (1, 2):
            os.dup2(nowhere, number)
        yield
    finally:
        for number, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, number)
            os.close(copy)
        os.close(nowhere)
