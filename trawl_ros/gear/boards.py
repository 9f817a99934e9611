# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the otter board: its plate, its law, and the prior of its coefficients."""

from itertools import pairwise
from math import pi, sqrt
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.numbers import Coefficient, Degrees, NotNegative, Positive, Vector
from trawl_ros.records.coefficients import COEFFICIENTS

SEA_DENSITY_KG_M3 = 1025.0
"""Density of the water in the added mass of a plate."""


class StartRecord(Record):
    """Prior of the coefficients: start values, spread and bounds in the order of eq. 36."""

    start: tuple[Coefficient, ...]
    """Start values."""
    std: tuple[Positive, ...]
    """Standard deviations."""
    low: tuple[float, ...]
    """Lower bounds."""
    high: tuple[float, ...]
    """Upper bounds."""

    @model_validator(mode='after')
    def _twelve(self) -> 'StartRecord':
        for name in ('start', 'std', 'low', 'high'):
            if len(getattr(self, name)) != 12:
                raise ValueError(f'{name}: found {len(getattr(self, name))} numbers, expected 12')
        for i, (low, start, high) in enumerate(zip(self.low, self.start, self.high, strict=True)):
            if not low < high or not low <= start <= high:
                raise ValueError(
                    f'number {i + 1}: found low {low}, start {start}, high {high}, expected '
                    'low <= start <= high and low < high'
                )
        return self


class CoefficientsRecord(Record):
    """The twelve coefficients of eq. 14, in the order of eq. 36; angles in radians."""

    a1: Coefficient
    c1: Coefficient
    a2: Coefficient
    c2: Coefficient
    b3: Coefficient
    c3: Coefficient
    a4: Coefficient
    c4: Coefficient
    b5: Coefficient
    c5: Coefficient
    a6: Coefficient
    c6: Coefficient

    def array(self) -> NDArray[np.float64]:
        """Return the values (12,) in the order of `COEFFICIENTS`."""
        return np.array([getattr(self, name) for name in COEFFICIENTS])


class InertiaRecord(Record):
    """Moments and products of inertia about the board's axes (Table 1)."""

    xx_kg_m2: Positive
    """Moment about the chord."""
    yy_kg_m2: Positive
    """Moment about the normal."""
    zz_kg_m2: Positive
    """Moment about the span."""
    xy_kg_m2: float
    """Product of inertia."""
    xz_kg_m2: float
    """Product of inertia."""
    yz_kg_m2: float
    """Product of inertia."""


class FasteningRecord(Record):
    """Fastening points in the outward board frame, whose origin is the centre of gravity."""

    warp_m: Vector
    """Hole for the warp, which may be on a bracket off the plate."""
    upper_bridle_m: Vector
    """Upper bridle point."""
    lower_bridle_m: Vector
    """Lower bridle point."""


class InstallationRecord(Record):
    """Installation angles: rotations of the board about its z, y, x axes against its rigging."""

    epsilon_deg: Degrees = 0.0
    """Turn about z, along the span: changes the attack angle."""
    zeta_deg: Degrees = 0.0
    """Turn about y, normal to the board: changes the pitch."""
    eta_deg: Degrees = 0.0
    """Turn about x, along the chord: changes the lean."""


class PolarPointRecord(Record):
    """Lift, drag and centre of pressure of a board at an angle of attack.

    ``ahead_chords`` is the distance of the centre of pressure ahead of the centre of gravity, in
    chords.
    """

    attack_deg: Annotated[float, Field(ge=-40, le=90)]
    lift: Annotated[float, Field(ge=-4, le=4)]
    drag: Annotated[float, Field(ge=0, le=4)]
    ahead_chords: Annotated[float, Field(ge=-1, le=1)] | None = None


class TiltPointRecord(Record):
    """Loads of a tilted board in a level flow, along the axes of the flume tank.

    ``tilt_deg`` is the heel, positive with the outward normal up (upper edge inward), or the trim,
    positive with the nose up. ``lift_factor`` multiplies the horizontal lift of the upright board;
    ``upward`` is the whole upward force coefficient C_Z on the board's area.
    """

    tilt_deg: Annotated[float, Field(ge=-45, le=45)]
    lift_factor: Annotated[float, Field(ge=0.2, le=3)] = 1.0
    upward: Annotated[float, Field(ge=-2, le=2)]


Tilts = Annotated[tuple[TiltPointRecord, ...], Field(max_length=30)]


def _tilts_rise(**tables: tuple[TiltPointRecord, ...]) -> None:
    for name, points in tables.items():
        tilts = [point.tilt_deg for point in points]
        if tilts and (any(b <= a for a, b in pairwise(tilts)) or not tilts[0] <= 0 <= tilts[-1]):
            raise ValueError(f'{name}: found tilt_deg {tilts}, expected rising angles that span 0')


def _rising(points: tuple[PolarPointRecord, ...]) -> None:
    attacks = [point.attack_deg for point in points]
    if any(b <= a for a, b in pairwise(attacks)):
        raise ValueError(f'points: angles must rise, found {attacks}')
    if len({point.ahead_chords is None for point in points}) > 1:
        raise ValueError('points: found ahead_chords at some angles, expected it at all or none')


class DoorRecord(Record):
    """Door of the catalogue: published lift and drag, with their source.

    ``heel`` and ``trim`` are measured changes of the loads of a tilted board.
    """

    name: str
    source: str
    aspect_ratio: Positive | None = None
    points: Annotated[tuple[PolarPointRecord, ...], Field(min_length=2, max_length=60)]
    heel: Tilts = ()
    trim: Tilts = ()

    @model_validator(mode='after')
    def _angles_rise(self) -> 'DoorRecord':
        _rising(self.points)
        _tilts_rise(heel=self.heel, trim=self.trim)
        return self


class BoardLawRecord(Record):
    """Law of a board in place of eq. 14, whose straight lines are then added to it.

    A ``table`` has points of a flume tank, or those of a ``door`` of the catalogue. A ``foil``
    computes them for a cambered board that stalls at ``stall_deg`` with the lift ``max_lift``. A
    table may have ``heel`` and ``trim``, which replace those of its door.
    """

    kind: Literal['table', 'foil']
    door: str | None = None
    points: Annotated[tuple[PolarPointRecord, ...], Field(max_length=60)] = ()
    heel: Tilts = ()
    trim: Tilts = ()
    max_lift: Annotated[float, Field(gt=0.3, le=4)] | None = None
    stall_deg: Annotated[float, Field(gt=5, le=40)] | None = None
    camber: Annotated[float, Field(ge=0, le=0.3)] = 0.0
    base_drag: Annotated[float, Field(ge=0, le=0.5)] = 0.05

    @model_validator(mode='after')
    def _whole(self) -> 'BoardLawRecord':
        given = bool(self.points) + (self.door is not None)
        if self.kind == 'table' and given != 1:
            raise ValueError(f'found {given} of door and points, expected one of them for a table')
        if self.kind == 'table' and self.door is None and len(self.points) < 2:
            raise ValueError(f'points: found {len(self.points)}, expected at least 2 for a table')
        if self.kind == 'foil' and (given or self.heel or self.trim):
            raise ValueError('found door, points, heel or trim, expected none of them for a foil')
        if self.kind == 'foil' and (self.max_lift is None or self.stall_deg is None):
            raise ValueError('max_lift or stall_deg: missing, expected both for a foil')
        _rising(self.points)
        _tilts_rise(heel=self.heel, trim=self.trim)
        return self


class BoardRecord(Record):
    """Otter board; the starboard board is the mirror image of the port board.

    Inertia and added mass are those of a plate of this span and chord by default. With a ``law``
    the coefficients of eq. 14 are corrections to it, zero by default.
    """

    mass_kg: Positive
    """Mass."""
    volume_m3: Positive
    """Displaced volume."""
    inertia: InertiaRecord
    """Inertia about the centre of gravity; default that of an even plate."""
    area_m2: Positive
    """Area to which coefficients refer."""
    span_m: Positive
    """Height."""
    chord_m: Positive
    """Length."""
    law: BoardLawRecord | None = None
    """Law in place of eq. 14."""
    coefficients: CoefficientsRecord
    """a1 to c6 of eq. 14, per radian; needed without a `law`, else corrections to it."""
    rotary_slope: NotNegative
    """Slope of the lift by which a turning board resists; needed without a `law`, else 2.5."""
    fastening: FasteningRecord
    """Fastening points."""
    installation: InstallationRecord = InstallationRecord()
    """Turn of the board against its fastening points."""
    added_mass_kg: tuple[NotNegative, NotNegative, NotNegative]
    """Added mass along x, y and z; default that of a plate, by strips with the correction of
    Pabst.
    """

    @model_validator(mode='before')
    @classmethod
    def _derived(cls, data: object) -> object:
        if not isinstance(data, dict):
            return data
        given = dict(data)
        _refuse_keys_of_0_1(given)
        sizes = [given.get(key) for key in ('mass_kg', 'volume_m3', 'span_m', 'chord_m')]
        known = [float(x) for x in sizes if isinstance(x, int | float) and x > 0]
        if len(known) == len(sizes):
            given.setdefault('inertia', plate_inertia(*known))
            given.setdefault('added_mass_kg', (0.0, plate_added_mass(known[2], known[3]), 0.0))
        if given.get('law') is not None:
            given.setdefault('coefficients', dict.fromkeys(COEFFICIENTS, 0.0))
            given.setdefault('rotary_slope', 2.5)
        return given

    @model_validator(mode='after')
    def _corrections(self) -> 'BoardRecord':
        if self.law is None:
            return self
        for name, low, high in zip(COEFFICIENTS, CORRECTIONS.low, CORRECTIONS.high, strict=True):
            if not low <= (value := getattr(self.coefficients, name)) <= high:
                raise ValueError(
                    f'coefficients.{name}: found {value:g} with a law, to which the coefficients '
                    f'are corrections, expected {low:g} to {high:g}. Delete `coefficients` if they '
                    'describe another board, or delete `law`'
                )
        return self


def _refuse_keys_of_0_1(given: dict[str, object]) -> None:
    found = [key for key in ('force_axes', 'moment_signs', 'slip_sign') if key in given]
    if found:
        raise ValueError(
            f'found {", ".join(found)} of a gear file of 0.1, expected none: loads now act in one '
            'frame, aft, outward and down (docs/from_0_1.md). Delete these keys and run '
            'trawl trim. To keep the loads of force_axes: flow, moment_signs: [-1, 1, 1] and '
            'slip_sign: -1, reverse the signs of c3, b5, a6 and c6'
        )


def plate_inertia(mass: float, volume: float, span: float, chord: float) -> dict[str, float]:
    """Return the inertia (kg m²) of a plate whose thickness follows from its volume (m³)."""
    thick = volume / (span * chord)
    return {
        'xx_kg_m2': mass * (span**2 + thick**2) / 12,
        'yy_kg_m2': mass * (span**2 + chord**2) / 12,
        'zz_kg_m2': mass * (chord**2 + thick**2) / 12,
        'xy_kg_m2': 0.0,
        'xz_kg_m2': 0.0,
        'yz_kg_m2': 0.0,
    }


def plate_added_mass(span: float, chord: float) -> float:
    """Return the added mass (kg) of a rectangular plate normal to its face.

    It is that of strips, with the correction of Pabst for the aspect ratio.
    """
    aspect = max(span, chord) / min(span, chord)
    strips = SEA_DENSITY_KG_M3 * pi / 4 * min(span, chord) ** 2 * max(span, chord)
    return strips * aspect / sqrt(1 + aspect**2) * (1 - 0.425 * aspect / (1 + aspect**2))


CORRECTIONS = StartRecord(
    start=(0.0,) * 12,
    std=(0.3, 0.05, 0.5, 0.2, 0.3, 0.05, 0.2, 0.1, 0.3, 0.05, 0.3, 0.15),
    low=(-2.0, -0.3, -2.0, -1.0, -2.0, -0.5, -2.0, -0.5, -1.0, -0.5, -2.0, -0.5),
    high=(2.0, 0.3, 2.0, 1.0, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5),
)
"""Prior of the corrections to a board's law if the gear file has none; assumed."""
