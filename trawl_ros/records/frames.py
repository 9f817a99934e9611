# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Frames: where those of sensors are fixed, and the names that a user gives to frames."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from trawl_ros.records.registry import (
    DOOR_FRAMES,
    DOOR_SPREAD,
    ECHO_SOUNDER,
    MAP,
    ODOM,
    SLANT_RANGE,
    SONAR,
    SONAR_WIDTH,
    VESSEL,
    Topic,
)

WITHOUT_PREFIX = (MAP,)
"""Frames that all ships share."""


@dataclass(frozen=True)
class Mount:
    """Mount: frame of a sensor that is fixed to another frame.

    Attributes
    ----------
    frame, parent
        Names of both.
    position
        Origin in the parent, m.
    angles
        Roll, pitch and yaw in the parent, rad (REP-103).
    sentence
        Where x points.
    """

    frame: str
    parent: str
    position: tuple[float, float, float]
    angles: tuple[float, float, float]
    sentence: str


_ORIGIN = (0.0, 0.0, 0.0)


def echo_sounder_mount(draught_m: float) -> Mount:
    """Return the mount of the echo sounder, with its depth below the towing blocks (m)."""
    down = (0.0, 0.5 * math.pi, 0.0)
    return Mount(ECHO_SOUNDER, VESSEL, (0.0, 0.0, -draught_m), down, 'at the keel, x down')


SPREAD_MOUNT = Mount(
    DOOR_SPREAD,
    DOOR_FRAMES['port'],
    _ORIGIN,
    (0.0, 0.0, -0.5 * math.pi),
    'x to starboard, towards the other door',
)
SLANT_MOUNT = Mount(
    SLANT_RANGE,
    VESSEL,
    _ORIGIN,
    (0.0, 0.0, math.pi),
    'midway between the towing blocks, x astern; the range is to a door, wherever that is',
)
DOOR_MOUNTS = (SPREAD_MOUNT, SLANT_MOUNT)
WIDTH_MOUNT = Mount(
    SONAR_WIDTH, SONAR, _ORIGIN, (0.0, 0.0, 0.5 * math.pi), 'x to port, along the width'
)


FRAME_SENTENCES = {
    MAP: 'ENU, origin at the datum on the mean surface (REP-105)',
    ODOM: 'only where parameter odom_frame is set: between map and the ship (REP-105)',
    VESSEL: 'midway between the towing blocks: x forward, y port, z up; base_link of REP-105',
    **{
        frame: f'centre of gravity of the {side} door: x forward, y port, z up'
        for side, frame in DOOR_FRAMES.items()
    },
    SONAR: "headrope's centre: x down, y port, z forward",
    ECHO_SOUNDER: 'at the keel, x down',
    DOOR_SPREAD: SPREAD_MOUNT.sentence,
    SLANT_RANGE: SLANT_MOUNT.sentence,
    SONAR_WIDTH: WIDTH_MOUNT.sentence,
}
"""Origin and axes of each frame."""


def frames_of(node: str, rows: Iterable[Topic]) -> tuple[str, ...]:
    """Return the frames that a node writes, and their parents, from the rows of the registry."""
    used = {row.frame for row in rows if node in row.published_by}
    used |= {mount.parent for mount in (*DOOR_MOUNTS, WIDTH_MOUNT) if mount.frame in used}
    return tuple(frame for frame in FRAME_SENTENCES if frame in used)


def frame_names(given: Mapping[str, str], prefix: str) -> dict[str, str]:
    """Return the published name of each frame whose name differs from its own.

    Parameters
    ----------
    given
        Names by frame.
    prefix
        Put before all names but that of ``map``, as ``ship_a/``.
    """
    full = {
        frame: name if frame in WITHOUT_PREFIX else f'{prefix}{name}'
        for frame, name in given.items()
    }
    return {frame: name for frame, name in full.items() if name != frame}
