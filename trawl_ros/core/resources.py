# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Look-up of files, by path or by name in the package."""

from collections.abc import Iterable
from difflib import get_close_matches
from pathlib import Path

from trawl_ros.core.errors import TrawlError

PACKAGE = 'trawl_ros'


def share_path(*parts: str) -> Path:
    """Find a file or folder of the package.

    The data of the running copy of the package take precedence: first those of its source checkout
    (or editable install), then those in the prefix where it is installed, then those of the ament
    index.

    Parameters
    ----------
    *parts : str
        Path below the share folder, such as ``'config', 'gear', 'kaifuha.yaml'``; nothing for
        the share folder itself.

    Returns
    -------
    Path
        Absolute path that exists.

    Raises
    ------
    TrawlError
        If the data of the package are not installed, or contain nothing of this name.
    """
    module = Path(__file__).resolve()
    folder = _beside(module) or _in_prefix_of(module) or _in_ament_index()
    if folder is None:
        raise TrawlError(
            f'the data of {PACKAGE} (config/ and bags/) are missing, expected in the source '
            f'checkout of the package, or in share/{PACKAGE} of the prefix of {module}'
        )
    path = folder.joinpath(*parts)
    if not path.exists():
        raise TrawlError(f'{path}: {PACKAGE} has no such file or folder{_siblings(path)}')
    return path


def packaged(path: str | Path, folder: str, error: type[TrawlError] = TrawlError) -> Path:
    """Find a YAML file by path, or by its name in ``config/<folder>``, with or without ``.yaml``.

    The scenario of the sample bag lies next to it, in ``bags``.

    Raises
    ------
    TrawlError
        Of the type ``error``, if a name is not one of the package.
    """
    path = Path(path)
    if path.is_file() or len(path.parts) != 1:
        return path
    is_yaml = path.suffix in ('.yaml', '.yml')
    name = f'{path.stem if is_yaml else path}.yaml'
    if folder == 'scenarios' and (sample := _sample(name)):
        return sample
    try:
        return share_path('config', folder, name)
    except TrawlError as reason:
        if is_yaml:  # the caller says that there is no such file
            return path
        # The first part names a path inside the package, which says nothing to the caller.
        hint = str(reason).partition('; ')[2]
        found = 'found a folder' if path.is_dir() else 'no such file'
        raise error(
            f'{path}: {found}, expected a file or a name of the package; {hint}'
        ) from reason


def packaged_bag(path: str | Path) -> Path:
    """Find a bag by path, or a sample bag of the package by its name."""
    path = Path(path)
    sample = None if path.exists() or len(path.parts) != 1 else _sample(path.name)
    return sample or path


def bag_name(path: str | Path) -> str:
    """Return the name by which `packaged_bag` finds a sample bag, the path of any other."""
    name = Path(path).name
    return name if packaged_bag(name) == Path(path) else str(path)


def names_in(folder: Path) -> list[str]:
    """List the names in a folder, without hidden ones; none if it cannot be read."""
    try:
        return sorted(entry.name for entry in folder.iterdir() if not entry.name.startswith('.'))
    except OSError:
        return []


def nearest(name: str, names: Iterable[str]) -> str:
    """Ask whether the nearest name was meant; an empty text if none is near."""
    near = get_close_matches(name, names, n=1, cutoff=0.8)
    return f'; did you mean {near[0]}?' if near else ''


def _sample(name: str) -> Path | None:
    """Return a file or folder of the package's ``bags``, None if there is none of this name."""
    try:
        return share_path('bags', name)
    except TrawlError:
        return None


def _beside(module: Path) -> Path | None:
    """Return the source checkout that contains `module`."""
    checkout = module.parents[2]
    return checkout if (checkout / 'package.xml').is_file() else None


def _in_prefix_of(module: Path) -> Path | None:
    """Return the share folder of the prefix (workspace, virtual environment, /usr) of `module`."""
    for prefix in module.parents[2:]:
        share = prefix / 'share' / PACKAGE
        if (share / 'package.xml').is_file():
            return share
    return None


def _in_ament_index() -> Path | None:
    """Return the share folder by ROS 2, for layouts with Python and data in two prefixes."""
    try:
        from ament_index_python.packages import get_package_share_directory
    except ImportError:
        return None
    try:
        return Path(get_package_share_directory(PACKAGE))
    except (LookupError, OSError):  # not in the index, or no index
        return None


def _siblings(path: Path) -> str:
    """Suggest names that the user may have meant instead of `path`."""
    if not path.parent.is_dir():
        return ''
    names = [Path(name).stem for name in names_in(path.parent)]
    known = f'; there are: {", ".join(names)}' if names else '; the folder is empty'
    return nearest(path.stem, names) or known
