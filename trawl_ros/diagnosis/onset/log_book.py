# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Log book of findings: what was published to whom and when, a line of JSON for each event."""

import json
import os
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending, is_there
from trawl_ros.core.foreign import open_file, parse_json
from trawl_ros.diagnosis.onset.findings import Finding

Event = Literal['begun', 'raised', 'published', 'settled', 'withdrawn', 'acknowledged', 'dismissed']

MOST_BYTES = 5_000_000
"""A file of this size becomes the older one, in place of the one before: twice as much is kept."""

MOST_TOLD = 50
"""Nodes named in one event: with the longest names that ROS allows, 13 kB."""

LONGEST_LINE = 20_000

BEGINNING = b'{"time": "'
KEYS = frozenset({'time', 'event', 'stamp_ns', 'who'})
"""Beginning and keys of a line: they tell a log book and a foreign file apart."""


class LogBook:
    """Log book in a file that only ever grows, until it is set aside as ``….1``.

    Each line is on the disk before the next thing happens. A line that a kill cut short is removed
    when the file is opened again.

    Parameters
    ----------
    path
        Of the file: a new or empty one, or a log book.

    Raises
    ------
    TrawlError
        If it cannot be written to, or holds something else, as the older file may.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        _checked(self.older)
        whole = _checked(path).rfind(b'\n') + 1
        with appending(path) as file:
            file.truncate(whole)

    @property
    def older(self) -> Path:
        """File with what went before."""
        return self.path.with_name(f'{self.path.name}.1')

    def write(
        self,
        event: Event,
        stamp: int,
        who: str,
        finding: Finding | None = None,
        to: Sequence[str] = (),
    ) -> None:
        """Add an event.

        Parameters
        ----------
        event, stamp, who
            Event, the stamp (ns) that the data had come to, and whose doing it was.
        finding
            The finding that it is about.
        to
            Nodes that were told.

        Raises
        ------
        TrawlError
            If it cannot be written.
        """
        now = datetime.now(UTC).isoformat(timespec='milliseconds')
        line: dict[str, object] = {'time': now, 'event': event, 'stamp_ns': stamp, 'who': who}
        if to:
            line['to'] = to[:MOST_TOLD]
        if finding is not None:
            line |= {
                'finding': finding.number, 'sentence': finding.sentence(),
                'onset_ns': finding.onset_ns, 'name': finding.name, 'alike': finding.alike,
            }  # fmt: skip
        self._set_aside()
        with appending(self.path) as file:
            file.write(json.dumps(line, ensure_ascii=False) + '\n')
            file.flush()
            os.fsync(file.fileno())

    def events(self) -> list[Mapping[str, object]]:
        """Events so far, those set aside first; lines that are none are left out."""
        lines = (line for path in (self.older, self.path) for line in _checked(path).splitlines())
        return [event for line in lines if (event := _event(line)) is not None]

    def last_number(self) -> int:
        """Number of the last finding, 0 where there is none."""
        numbers = (event.get('finding') for event in self.events())
        return max((one for one in numbers if isinstance(one, int)), default=0)

    def _set_aside(self) -> None:
        try:
            if self.path.exists() and self.path.stat().st_size > MOST_BYTES:
                _checked(self.older)
                self.path.replace(self.older)
        except OSError as reason:
            raise TrawlError(f'{self.path}: cannot be written ({reason.strerror})') from reason


def _checked(path: Path) -> bytes:
    """Read a log book; a file that does not exist or is empty has no lines.

    Raises
    ------
    TrawlError
        If something else is there, or the file is larger than a log book becomes.
    """
    if not is_there(path, TrawlError):
        return b''
    with open_file(path, TrawlError) as stream:
        data = stream.read(MOST_BYTES + LONGEST_LINE + 1)
    first, newline, _ = data.partition(b'\n')
    last = data[data.rfind(b'\n') + 1 :]
    foreign = newline and _event(first) is None
    # A last line without an end is the beginning of one that a kill cut short.
    cut = last.startswith(BEGINNING) or BEGINNING.startswith(last)
    if foreign or not cut or len(data) > MOST_BYTES + LONGEST_LINE:
        raise TrawlError(
            f'{path}: holds something other than events of a log book, and is left as it is; '
            'expected a new or empty file, or a log book'
        )
    return data


def _event(line: bytes) -> Mapping[str, object] | None:
    try:
        event = parse_json(line)
    except ValueError:
        return None
    return event if isinstance(event, dict) and event.keys() >= KEYS else None
