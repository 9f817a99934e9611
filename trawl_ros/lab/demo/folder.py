# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Folder of a demo's results, and the check before an older one is replaced."""

import json
import shutil
from pathlib import Path
from typing import Any

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import write_json

MADE_BY = 'trawl demo'
SUMMARY = 'summary.json'


class DemoFolder:
    """Folder of one demo.

    It is marked from the beginning, so that a later demo can replace it even if this one is
    interrupted.

    Parameters
    ----------
    path
        New, empty, or left by an earlier demo.

    Raises
    ------
    TrawlError
        If it holds other files, or cannot be made.
    """

    SENTENCES = 'marport.nmea'
    RESULTS = 'identification'
    HIDDEN = 'hidden'

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            if path.exists() and any(path.iterdir()):
                self._require_former_demo()
                self._clear()
            path.mkdir(parents=True, exist_ok=True)
            self.write_summary({'finished': False})
        except OSError as reason:
            raise TrawlError(f'{path}: cannot be used ({reason.strerror})') from reason

    @property
    def bag(self) -> Path:
        """Bag of the recorded trial."""
        return self.path / 'bag'

    @property
    def logs(self) -> Path:
        """Folder of the nodes' logs."""
        return self.path / 'log'

    @property
    def results(self) -> Path:
        """Folder of `identification_node`'s report."""
        return self.path / self.RESULTS

    @property
    def hidden(self) -> Path:
        """Folder of the diagnosis of a hidden effect."""
        return self.path / self.HIDDEN

    def gather_results(self) -> list[str]:
        """Move the report into the demo's folder; return the names of its files."""
        names = sorted(file.name for file in self.results.iterdir())
        for name in names:
            (self.results / name).replace(self.path / name)
        self.results.rmdir()
        return names

    def write_summary(self, content: dict[str, Any]) -> None:
        """Write ``summary.json``."""
        write_json(self.path / SUMMARY, {'made_by': MADE_BY, **content}, indent=2)

    def _require_former_demo(self) -> None:
        try:
            content = json.loads((self.path / SUMMARY).read_text(encoding='utf-8'))
        except (OSError, ValueError):
            content = None
        if not isinstance(content, dict) or content.get('made_by') != MADE_BY:
            raise TrawlError(
                f'{self.path}: holds files that `trawl demo` has not written and does not replace; '
                'expected a new folder, an empty one, or that of an earlier demo'
            )

    def _clear(self) -> None:
        for folder in (self.bag, self.logs, self.results, self.hidden):
            if folder.is_dir():
                shutil.rmtree(folder)
        results = (
            self.path / name for name in (self.SENTENCES, 'identification.json', 'report.html')
        )
        for file in (*results, *self.path.glob('*.png')):
            file.unlink(missing_ok=True)
