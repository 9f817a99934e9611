# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Import of reference codes, with a clear error if one is not installed."""

from importlib import import_module
from types import ModuleType

from trawl_ros.core.errors import TrawlError


class PeerAbsent(TrawlError):
    """Error: a reference code is not installed."""


class PeerFailed(TrawlError):
    """Error: a reference code failed."""


def peer(name: str) -> ModuleType:
    """Import the module of a reference code.

    Raises
    ------
    PeerAbsent
        If it is not installed.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        raise PeerAbsent(
            f'{name} is not installed; `pip install trawl_ros[peers]` brings all programs '
            'to compare with'
        ) from None
