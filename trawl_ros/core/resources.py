"""Look-up of files: as a user names them, or as they come with the package."""

import difflib
from pathlib import Path

from trawl_ros.core.errors import TrawlError

PACKAGE = 'trawl_ros'


def share_path(*parts: str) -> Path:
    """Find a file or folder that comes with the package.

    The data of the very copy of the package that runs are preferred: those beside it in a source
    checkout (or editable install), then those in the prefix where it is installed, and only then
    those that the ament index names.

    Parameters
    ----------
    *parts : str
        Path below the share folder, such as ``'config', 'gear', 'kaifuha.yaml'``; nothing for
        the share folder itself.

    Returns
    -------
    Path
        Absolute path of something that exists.

    Raises
    ------
    TrawlError
        If the package's data are not installed, or hold nothing of this name.

    """
    module = Path(__file__).resolve()
    folder = _beside(module) or _in_prefix_of(module) or _in_ament_index()
    if folder is None:
        raise TrawlError(
            f'the data of {PACKAGE} (config/ and bags/) are missing: expected them beside the '
            f'package in a source checkout, or in share/{PACKAGE} of the prefix that holds {module}'
        )
    path = folder.joinpath(*parts)
    if not path.exists():
        raise TrawlError(f'{path}: {PACKAGE} comes with no such file or folder{_siblings(path)}')
    return path


def packaged(path: str | Path, folder: str, error: type[TrawlError] = TrawlError) -> Path:
    """Find a YAML file: as given, or by its bare name in ``config/<folder>``.

    Raises
    ------
    TrawlError
        Of the type ``error``, if a bare name is not one of those that come with the package.
    """
    path = Path(path)
    if path.suffix in ('.yaml', '.yml') or path.is_file() or len(path.parts) != 1:
        return path
    try:
        return share_path('config', folder, f'{path}.yaml')
    except TrawlError as reason:
        raise error(f'{path}: neither a file nor a name of the package; {reason}') from reason


def _beside(module: Path) -> Path | None:
    """Folder of the source checkout that `module` is part of."""
    checkout = module.parents[2]
    return checkout if (checkout / 'package.xml').is_file() else None


def _in_prefix_of(module: Path) -> Path | None:
    """Share folder of the prefix (workspace, virtual environment, /usr) that has `module`."""
    for prefix in module.parents[2:]:
        share = prefix / 'share' / PACKAGE
        if (share / 'package.xml').is_file():
            return share
    return None


def _in_ament_index() -> Path | None:
    """Share folder that ROS 2 knows, for layouts that keep Python and data in two prefixes."""
    try:
        from ament_index_python.packages import get_package_share_directory
    except ImportError:
        return None
    try:
        return Path(get_package_share_directory(PACKAGE))
    except (LookupError, OSError):  # no such package in the index, or no index at all
        return None


def _siblings(path: Path) -> str:
    """Names a user may have meant instead of `path`."""
    if not path.parent.is_dir():
        return ''
    names = sorted(entry.name for entry in path.parent.iterdir() if not entry.name.startswith('.'))
    if near := difflib.get_close_matches(path.name, names, n=1, cutoff=0.8):
        return f'; did you mean {Path(near[0]).stem}?'
    return f'; there are: {", ".join(names)}' if names else '; the folder is empty'
