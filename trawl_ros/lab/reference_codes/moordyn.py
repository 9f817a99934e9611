"""Running system of MoorDyn."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.lab.reference_codes.absent import PeerFailed, peer

HEADER = 9
"""Bytes of a file of MoorDyn's state before its numbers: a name and a version."""


class MoorDyn:
    """System of lines and points; close it, or use it in a ``with`` statement.

    Parameters
    ----------
    text
        The input file, from `moordyn_input.input_file`.
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
        words = np.frombuffer(content, '<f8', offset=HEADER)
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
        """Set the rate (m/s) of change of a line's (from 0) unstretched length."""
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

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
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
