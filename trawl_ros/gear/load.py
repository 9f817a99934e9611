"""Loading a gear file."""

from pathlib import Path

from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.gear.records import GearRecord


def load_gear(path: str | Path) -> GearRecord:
    """Read and check a gear file.

    Parameters
    ----------
    path
        A file, or the name of a gear that comes with the package, such as ``'kaifuha'``.

    Raises
    ------
    GearError
        Naming file, key, what was found and what was expected.
    """
    path = packaged(path, 'gear', GearError)
    return validated(GearRecord, load_yaml(path, GearError), path, GearError)
