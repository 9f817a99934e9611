# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Polars: lift, drag and centre of pressure of a board over its angle of attack."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.gear.boards import BoardLawRecord, BoardRecord, DoorRecord, TiltPointRecord

CENTRE_AHEAD_CHORDS = (0.15, 0.0)
"""Default centre of pressure ahead of the middle at zero attack and from `STALLED_DEG` on.

It moves aft as a board stalls. Assumed; see `docs/gear_format.md`.
"""

FOIL_EFFICIENCY = 0.8
"""Span efficiency of the induced drag of a foil; assumed."""

STALLED_DEG = 45.0
"""Angle of attack at which a foil is fully stalled and acts as a flat plate."""

PLATE_LIFT = 0.85
"""Lift of a stalled plate, C_L = `PLATE_LIFT` sin 2α; FAO's doors have 0.76 (flat), 0.88 (oval)."""


@dataclass(frozen=True)
class Tilt:
    """Loads of a tilted board in a level flow, each (m,).

    ``sine`` of the tilt, rising; ``lift_factor`` of the horizontal lift; ``upward`` force
    coefficient C_Z.
    """

    sine: FloatArray
    lift_factor: FloatArray
    upward: FloatArray


UPRIGHT = Tilt(np.zeros(1), np.ones(1), np.zeros(1))
"""Tilt of a board without measured tilts; its loads rotate with it."""


@dataclass(frozen=True)
class Polar:
    """Polar of a board.

    Attributes
    ----------
    attack : (n,) array
        Rising angles of attack, rad.
    lift, drag, ahead : (n,) arrays
        C_L, C_D, and the centre of pressure in chords ahead of the centre of gravity.
    heel, trim
        Tilts by the vertical part of the outward normal and of the forward axis.
    """

    attack: FloatArray
    lift: FloatArray
    drag: FloatArray
    ahead: FloatArray
    heel: Tilt = UPRIGHT
    trim: Tilt = UPRIGHT


def load_door(name: str) -> DoorRecord:
    """Read a door of the catalogue in ``config/doors``, or a file like those.

    Raises
    ------
    GearError
        If the file is missing or a value is wrong; it names file, key, found and expected values.
    """
    path = packaged(name, 'doors', GearError)
    return validated(DoorRecord, load_yaml(path, GearError), path, GearError)


def polar_of(board: BoardRecord) -> Polar | None:
    """Return the polar of a table or foil; None for a law without any."""
    law = board.law
    if law is None or law.kind not in ('table', 'foil'):
        return None
    if law.kind == 'foil':
        return _foil(law, board.span_m**2 / board.area_m2)
    table = law if law.door is None else load_door(law.door)
    points = table.points
    attack = np.array([point.attack_deg for point in points])
    given = [point.ahead_chords for point in points]
    ahead = [_usual_ahead(a) if x is None else x for a, x in zip(attack, given, strict=True)]
    return Polar(
        np.radians(attack),
        np.array([point.lift for point in points]),
        np.array([point.drag for point in points]),
        np.array(ahead),
        _tilt(law.heel or table.heel),
        _tilt(law.trim or table.trim),
    )


def _tilt(points: tuple[TiltPointRecord, ...]) -> Tilt:
    if not points:
        return UPRIGHT
    return Tilt(
        np.sin(np.radians([point.tilt_deg for point in points])),
        np.array([point.lift_factor for point in points]),
        np.array([point.upward for point in points]),
    )


def _usual_ahead(attack_deg: float) -> float:
    share = float(np.clip(attack_deg / STALLED_DEG, 0.0, 1.0))
    attached, stalled = CENTRE_AHEAD_CHORDS
    return attached + share * (stalled - attached)


def _foil(law: BoardLawRecord, aspect: float) -> Polar:
    """Return the polar of a cambered board.

    Lift begins with Helmbold's slope at the zero lift of a circular arc and has its maximum at the
    stall. Beyond it the board becomes a flat plate.
    """
    assert law.max_lift is not None
    assert law.stall_deg is not None
    slope = 2 * np.pi * aspect / (2 + np.sqrt(aspect**2 + 4))
    stall, end = np.radians([law.stall_deg, STALLED_DEG])
    # Imported here: the import is slow, and boards by formula do not need it.
    from scipy.interpolate import CubicHermiteSpline

    start = min(slope * 2 * law.camber, 0.6 * law.max_lift)
    # A cubic is monotone up to three times the mean slope.
    rise = min(slope, 2.5 * (law.max_lift - start) / stall)
    lift = CubicHermiteSpline(
        [0.0, stall, end],
        [start, law.max_lift, PLATE_LIFT * np.sin(2 * end)],
        [rise, 0.0, 2 * PLATE_LIFT * np.cos(2 * end)],
    )
    attack = np.unique(np.concatenate([np.linspace(0.0, stall, 9), np.linspace(stall, end, 9)]))
    induced = law.base_drag + lift(np.minimum(attack, stall)) ** 2 / (
        np.pi * FOIL_EFFICIENCY * aspect
    )
    # In fully separated flow the force is normal to the plate.
    plate = law.base_drag + PLATE_LIFT * np.sin(2 * end) * np.tan(end)
    drag = induced + np.maximum(attack - stall, 0.0) / (end - stall) * (plate - induced)
    ahead = np.array([_usual_ahead(a) for a in np.degrees(attack)])
    return Polar(attack, lift(attack), drag, ahead)
