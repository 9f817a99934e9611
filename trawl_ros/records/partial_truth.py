# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Partial truth, for instruments that receive only part of it; other values are NaN."""

import math

import numpy as np

from trawl_ros.records.truth import (
    DoorTruth,
    NetTruth,
    SchoolTruth,
    SeabedTruth,
    Truth,
    VesselTruth,
    WinchTruth,
)

_THREE = np.full(3, math.nan)
_FOUR = np.full(4, math.nan)
_DOOR = DoorTruth(_THREE, _FOUR, _THREE, _THREE, math.nan, math.nan, math.nan, _THREE, _THREE)
_WINCH = WinchTruth(math.nan, math.nan, math.nan)
_NET = NetTruth(np.zeros((0, 3)), math.nan, math.nan, math.nan, _THREE, _FOUR)
_SEABED = SeabedTruth(math.nan, math.nan)
_VESSEL = VesselTruth(_THREE, math.nan, math.nan, _THREE, _THREE)


def partial_truth(
    stamp: int,
    *,
    doors: tuple[DoorTruth, DoorTruth] = (_DOOR, _DOOR),
    winches: tuple[WinchTruth, WinchTruth] = (_WINCH, _WINCH),
    net: NetTruth = _NET,
    vessel: VesselTruth = _VESSEL,
    schools: tuple[SchoolTruth, ...] = (),
    seabed: SeabedTruth = _SEABED,
) -> Truth:
    """Return the truth of one instant (ns) with the parts that are known."""
    return Truth(stamp, doors, winches, net, vessel, schools, seabed)
