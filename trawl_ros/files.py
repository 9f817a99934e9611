"""Files and folders: as a user names them, or as they come with the package; written whole."""

import json
from pathlib import Path
from typing import Any

from trawl_ros.errors import TrawlError
from trawl_ros.share import share_path


def packaged(path: Path, folder: str) -> Path:
    """Find a YAML file: as given, or by its bare name in ``config/<folder>``.

    Raises
    ------
    TrawlError
        If a bare name is not one of those that come with the package.
    """
    if path.suffix in ('.yaml', '.yml') or path.is_file() or len(path.parts) != 1:
        return path
    return share_path('config', folder, f'{path}.yaml')


def empty_folder(path: Path, *, force: bool) -> Path:
    """Check that results may go into a folder, which need not exist yet.

    Raises
    ------
    TrawlError
        If there is something in it already, unless ``force`` allows replacing it.
    """
    if path.is_dir() and any(path.iterdir()) and not force:
        raise TrawlError(
            f'{path}: holds files already, which are not written over; expected a new or empty '
            'folder, or --force'
        )
    return path


def write_json(path: Path, record: Any) -> None:
    """Write a file whole or not at all, whenever one is interrupted.

    Raises
    ------
    ValueError
        If a number is not finite, which JSON does not know.
    """
    beside = path.with_suffix('.part')
    beside.write_text(json.dumps(record, allow_nan=False) + '\n', encoding='utf-8')
    beside.replace(path)
