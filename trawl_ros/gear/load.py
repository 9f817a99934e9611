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

    Returns
    -------
    GearRecord
        Frozen, each value with its unit in its name.

    Raises
    ------
    GearError
        Naming file, key, what was found and what was expected.

    Examples
    --------
    >>> import trawl_ros
    >>> gear = trawl_ros.load_gear('kaifuha')
    >>> gear.warp.diameter_m, gear.board.area_m2
    (0.032, 12.0)
    """
    path = packaged(path, 'gear', GearError)
    return validated(GearRecord, load_yaml(path, GearError), path, GearError)
