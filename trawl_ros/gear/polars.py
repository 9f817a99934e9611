"""Polars: lift, drag and centre of pressure of a board over its angle of attack."""

from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.core.resources import packaged
from trawl_ros.core.schema import load_yaml, validated
from trawl_ros.gear.boards import BoardLawRecord, BoardRecord, DoorRecord, TiltPointRecord

AHEAD, AHEAD_STALLED = 0.15, 0.0
"""Centre of pressure (chords ahead of the middle) at no attack and from 45°, where none is given:
it moves back as a board stalls. Assumed; see `docs/gear_format.md`."""

FOIL_EFFICIENCY = 0.8
"""Span efficiency of the induced drag of a foil; assumed."""

STALLED = 45.0
"""Angle (deg) at which a foil has stalled altogether and is a flat plate."""

PLATE = 0.85
"""C_L = `PLATE` sin 2α of a stalled plate; FAO's flat door has 0.76 at 45°, its oval one 0.88."""


@dataclass(frozen=True)
class Tilt:
    """Loads of a tilted board in a level flow: ``sine`` (m,) of the tilt, rising; ``lift_factor``
    of its horizontal lift and its ``upward`` force coefficient C_Z, each (m,).
    """

    sine: FloatArray
    lift_factor: FloatArray
    upward: FloatArray


UPRIGHT = Tilt(np.zeros(1), np.ones(1), np.zeros(1))
"""Of a board whose loads turn with it whatever its tilt, since none was measured."""


@dataclass(frozen=True)
class Polar:
    """Polar of a board: ``attack`` (n,) rad, rising; ``lift`` C_L, ``drag`` C_D and ``ahead``, the
    centre of pressure in chords ahead of the centre of gravity, each (n,).

    ``heel`` is by the vertical part of the outward normal, ``trim`` by that of the forward axis.
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
        Naming file, key, what was found and what was expected.
    """
    path = packaged(name, 'doors', GearError)
    return validated(DoorRecord, load_yaml(path, GearError), path, GearError)


def polar_of(board: BoardRecord) -> Polar | None:
    """Polar of a board's law; None for the straight lines of eq. 14."""
    law = board.law
    if law is None:
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
    share = float(np.clip(attack_deg / STALLED, 0.0, 1.0))
    return AHEAD + share * (AHEAD_STALLED - AHEAD)


def _foil(law: BoardLawRecord, aspect: float) -> Polar:
    """Polar of a cambered board: Helmbold's slope of lift from the zero lift of a circular arc,
    levelling off at the stall; beyond it a flat plate.
    """
    assert law.max_lift is not None
    assert law.stall_deg is not None
    slope = 2 * np.pi * aspect / (2 + np.sqrt(aspect**2 + 4))
    stall, end = np.radians([law.stall_deg, STALLED])
    # Imported here: it takes long, and boards by formula have no use for it.
    from scipy.interpolate import CubicHermiteSpline

    start = min(slope * 2 * law.camber, 0.6 * law.max_lift)
    # A cubic that rises to its top without overshooting has at most three times the mean slope.
    rise = min(slope, 2.5 * (law.max_lift - start) / stall)
    lift = CubicHermiteSpline(
        [0.0, stall, end],
        [start, law.max_lift, PLATE * np.sin(2 * end)],
        [rise, 0.0, 2 * PLATE * np.cos(2 * end)],
    )
    attack = np.unique(np.concatenate([np.linspace(0.0, stall, 9), np.linspace(stall, end, 9)]))
    induced = law.base_drag + lift(np.minimum(attack, stall)) ** 2 / (
        np.pi * FOIL_EFFICIENCY * aspect
    )
    # Where the flow has left the back altogether, the force is across the plate.
    plate = law.base_drag + PLATE * np.sin(2 * end) * np.tan(end)
    drag = induced + np.maximum(attack - stall, 0.0) / (end - stall) * (plate - induced)
    ahead = np.array([_usual_ahead(a) for a in np.degrees(attack)])
    return Polar(attack, lift(attack), drag, ahead)
