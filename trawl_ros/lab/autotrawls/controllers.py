# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Controllers of the bench: those of the project, and a class of somebody else."""

import math
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from trawl_ros.control.autotrawl import Autotrawl
from trawl_ros.control.autotrawl_records import AutotrawlSettings
from trawl_ros.control.winch_controller import WinchController
from trawl_ros.core.errors import TrawlError
from trawl_ros.gear.records import WinchRecord
from trawl_ros.records.samples import WinchSample

MakeController = Callable[[tuple[float, float]], WinchController]
"""Makes a controller from the warp lengths (port, starboard), m, at the start."""


class StandingWinches:
    """Winches that are moved to the set lengths and stand otherwise."""

    def __init__(self, lengths: tuple[float, float]) -> None:
        self.wanted = lengths

    def set_lengths(self, port: float, starboard: float) -> None:
        """Change the set lengths (m)."""
        self.wanted = (port, starboard)

    def update(self, sample: WinchSample) -> tuple[float, float]:
        """Return the set lengths (m)."""
        return self.wanted


class ForeignController(StandingWinches):
    """Controller of somebody else; lengths that are no numbers leave the winches as they are.

    Parameters
    ----------
    controller
        Object with ``update(sample)``, which returns two lengths (m), and maybe ``set_lengths``.
    lengths
        At the start, m.
    """

    def __init__(self, controller: object, lengths: tuple[float, float]) -> None:
        super().__init__(lengths)
        self._controller = controller

    def set_lengths(self, port: float, starboard: float) -> None:
        """Pass changed set lengths (m) on, where the controller takes them."""
        if hasattr(self._controller, 'set_lengths'):
            self._controller.set_lengths(port, starboard)

    def update(self, sample: WinchSample) -> tuple[float, float]:
        """Update by a sample; return the wanted lengths (port, starboard), m."""
        found = getattr(self._controller, 'update')(sample)  # noqa: B009
        try:
            lengths = tuple(map(float, found))
        except (TypeError, ValueError):
            lengths = ()
        if len(lengths) != 2:
            raise TrawlError(
                f'{type(self._controller).__name__}.update: found {found!r}, expected the wanted '
                'lengths (port, starboard), m'
            )
        port, starboard = (
            wanted if math.isfinite(wanted) else held
            for wanted, held in zip(lengths, self.wanted, strict=True)
        )
        self.wanted = (port, starboard)
        return self.wanted


def shipped(winch: WinchRecord) -> dict[str, MakeController]:
    """Return the controllers of the project by name, for the winches of a gear."""
    limits = replace(
        AutotrawlSettings(),
        max_speed=winch.max_speed_m_s,
        max_acceleration=winch.max_acceleration_m_s2,
    )
    return {
        'standing': StandingWinches,
        'lengths': lambda lengths: Autotrawl(replace(limits, mode='lengths'), lengths),
        'tension': lambda lengths: Autotrawl(replace(limits, mode='tension'), lengths),
    }


def load_class(name: str) -> MakeController:
    """Load a controller of somebody else.

    Parameters
    ----------
    name
        ``module:Class``; the class takes the warp lengths (port, starboard), m, at the start.

    Raises
    ------
    TrawlError
        If there is none, or it has no ``update``.
    """
    module, _, kind = name.partition(':')
    try:
        found = getattr(import_module(module), kind)
    except (ImportError, AttributeError, ValueError) as reason:
        raise TrawlError(
            f'{name}: no such class ({reason}); expected one that can be imported, as module:Class'
        ) from reason
    if not callable(getattr(found, 'update', None)):
        raise TrawlError(
            f'{name}: no method update; expected update(sample), which returns lengths'
        )
    return lambda lengths: ForeignController(found(lengths), lengths)
