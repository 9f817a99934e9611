"""Hash of all that decides on a verdict: diagnosis, catalogue of effects, and library of mimics."""

from hashlib import sha256
from pathlib import Path

import trawl_ros.diagnosis
import trawl_ros.effects
from trawl_ros.core.resources import share_path

DECIDES_NOTHING = ('onset', 'report')
"""Folders that do not count: the watch over a tow in motion, and the texts of reports."""


def rules_hash() -> str:
    """SHA-256 of the files by their names and contents, in the order of the names."""
    digest = sha256()
    for folder, pattern in (
        (Path(trawl_ros.diagnosis.__path__[0]), '*.py'),
        (Path(trawl_ros.effects.__path__[0]), '*.py'),
        (share_path('config', 'mimics'), '*.yaml'),
    ):
        for file in sorted(folder.rglob(pattern)):
            name = file.relative_to(folder)
            if name.parts[0] not in DECIDES_NOTHING:
                digest.update(f'{folder.name}/{name.as_posix()}\n'.encode())
                digest.update(file.read_bytes())
    return digest.hexdigest()
