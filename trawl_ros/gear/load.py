# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Loading of a gear file."""

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
        A file, or the name of a gear in the package, such as ``'kaifuha'``.

    Returns
    -------
    GearRecord
        Frozen record; each key ends in its unit.

    Raises
    ------
    GearError
        If the file is missing or a value is wrong; it names file, key, found and expected values.

    Examples
    --------
    >>> import trawl_ros
    >>> gear = trawl_ros.load_gear('kaifuha')
    >>> gear.warp.diameter_m, gear.board.area_m2
    (0.032, 12.0)
    """
    path = packaged(path, 'gear', GearError)
    return validated(GearRecord, load_yaml(path, GearError), path, GearError)
