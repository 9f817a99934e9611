"""Log book of findings: who was told what and when, a line of JSON for each event."""

import json
import os
from collections.abc import Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Literal

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending
from trawl_ros.diagnosis.onset.findings import Finding

Event = Literal['begun', 'raised', 'published', 'settled', 'withdrawn', 'acknowledged', 'dismissed']

MOST_BYTES = 5_000_000
"""A file of this size becomes the older one, in place of the one before: twice as much is kept."""

LONGEST_LINE = 20_000


class LogBook:
    """Log book in a file that only ever grows, until it is set aside as ``….1``.

    Each line is on the disk before the next thing happens. A line that a kill cut short is taken
    off when the file is opened again.

    Parameters
    ----------
    path
        Of the file.

    Raises
    ------
    TrawlError
        If it cannot be written to.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._mend()
        appending(path).close()

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
        line: dict[str, object] = {
            'time': datetime.now(timezone.utc).isoformat(timespec='milliseconds'),
            'event': event,
            'stamp_ns': stamp,
            'who': who,
        }
        if to:
            line['to'] = list(to)
        if finding is not None:
            line |= {'finding': finding.number, 'sentence': finding.sentence()}
            line |= {'onset_ns': finding.onset_ns, 'name': finding.name}
            line['alike'] = list(finding.alike)
        text = json.dumps(line, ensure_ascii=False)[:LONGEST_LINE]
        try:
            if self.path.stat().st_size > MOST_BYTES:
                self.path.replace(self.older)
        except OSError as reason:
            raise TrawlError(f'{self.path}: cannot be written ({reason.strerror})') from reason
        with appending(self.path) as file:
            file.write(f'{text}\n')
            file.flush()
            os.fsync(file.fileno())

    def events(self) -> list[Mapping[str, object]]:
        """Events so far, those set aside first; lines that are none are left out."""
        found: list[Mapping[str, object]] = []
        for path in (self.older, self.path):
            if not path.exists():
                continue
            for line in path.read_text(encoding='utf-8', errors='replace').splitlines():
                try:
                    event = json.loads(line)
                except ValueError:
                    continue
                if isinstance(event, dict):
                    found.append(event)
        return found

    def last_number(self) -> int:
        """Number of the last finding, 0 where there is none."""
        numbers = (event.get('finding') for event in self.events())
        return max((one for one in numbers if isinstance(one, int)), default=0)

    def _mend(self) -> None:
        """Take off a last line without an end."""
        if self.path.is_symlink() or not self.path.exists():
            return
        data = self.path.read_bytes()
        whole = data.rfind(b'\n') + 1
        if whole < len(data):
            os.truncate(self.path, whole)
