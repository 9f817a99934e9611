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

SEA = 1025.0
"""Density (kg/m³) of the water that a turning plate carries along."""


class StartRecord(Record):
    """Prior of the coefficients: start values, spread and bounds in the order of eq. 36."""

    start: tuple[Coefficient, ...]
    std: tuple[Positive, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]

    @model_validator(mode='after')
    def _twelve(self) -> 'StartRecord':
        for name in ('start', 'std', 'low', 'high'):
            if len(getattr(self, name)) != 12:
                raise ValueError(f'{name}: needs 12 numbers, found {len(getattr(self, name))}')
        for i, (low, start, high) in enumerate(zip(self.low, self.start, self.high, strict=True)):
            if not low < high or not low <= start <= high:
                raise ValueError(
                    f'number {i + 1}: needs low <= start <= high and low < high, '
                    f'found {low}, {start}, {high}'
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
        """Values (12,), in the order of `COEFFICIENTS`."""
        return np.array([getattr(self, name) for name in COEFFICIENTS])


class InertiaRecord(Record):
    """Moments and products of inertia about the board's axes (Table 1)."""

    xx_kg_m2: Positive
    yy_kg_m2: Positive
    zz_kg_m2: Positive
    xy_kg_m2: float
    xz_kg_m2: float
    yz_kg_m2: float


class FasteningRecord(Record):
    """Fastening points in the outward board frame, origin in the centre of gravity."""

    warp_m: Vector
    upper_bridle_m: Vector
    lower_bridle_m: Vector


class InstallationRecord(Record):
    """Installation angles: turns of the board about its z, y, x axes against its rigging."""

    epsilon_deg: Degrees = 0.0
    zeta_deg: Degrees = 0.0
    eta_deg: Degrees = 0.0


class PolarPointRecord(Record):
    """Lift, drag and centre of pressure of a board at an angle of attack.

    ``ahead_chords`` is how far the centre of pressure lies ahead of the centre of gravity, in
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
    ``upward`` is the whole vertical force coefficient C_Z, upward, on the board's area.
    """

    tilt_deg: Annotated[float, Field(ge=-45, le=45)]
    lift_factor: Annotated[float, Field(ge=0.2, le=3)] = 1.0
    upward: Annotated[float, Field(ge=-2, le=2)]


Tilts = Annotated[tuple[TiltPointRecord, ...], Field(max_length=30)]


def _tilts_rise(**tables: tuple[TiltPointRecord, ...]) -> None:
    for name, points in tables.items():
        tilts = [point.tilt_deg for point in points]
        if tilts and (any(b <= a for a, b in pairwise(tilts)) or not tilts[0] <= 0 <= tilts[-1]):
            raise ValueError(
                f'{name}: found tilt_deg {tilts}, expected rising angles around 0, or 0 at an end'
            )


def _rising(points: tuple[PolarPointRecord, ...]) -> None:
    attacks = [point.attack_deg for point in points]
    if any(b <= a for a, b in pairwise(attacks)):
        raise ValueError(f'points: angles must rise, found {attacks}')
    if len({point.ahead_chords is None for point in points}) > 1:
        raise ValueError('points: found ahead_chords at some angles, expected it at all or at none')


class DoorRecord(Record):
    """A door of the catalogue: published lift and drag, with their source.

    ``heel`` and ``trim`` say how they change in a tilted board, where that was measured.
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
    """Law of a board in place of the straight lines of eq. 14, which are then added to it.

    ``table`` takes the points of a flume tank, or those of a ``door`` of the catalogue; ``foil``
    makes them for a cambered board that stalls at ``stall_deg`` with the lift ``max_lift``. A table
    may add ``heel`` and ``trim``, which replace those of its door.
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
            raise ValueError(f'a table needs either door or points, found {given} of them')
        if self.kind == 'table' and self.door is None and len(self.points) < 2:
            raise ValueError(f'points: a table needs at least 2, found {len(self.points)}')
        if self.kind == 'foil' and (given or self.heel or self.trim):
            raise ValueError('a foil makes its points itself, found door, points, heel or trim')
        if self.kind == 'foil' and (self.max_lift is None or self.stall_deg is None):
            raise ValueError('a foil needs max_lift and stall_deg, found none of one of them')
        _rising(self.points)
        _tilts_rise(heel=self.heel, trim=self.trim)
        return self


class BoardRecord(Record):
    """An otter board; both sides are the same board, mirrored.

    Inertia and added mass that are not given are those of a plate of this span and chord; with a
    ``law`` the coefficients of eq. 14 are corrections to it, zero unless given.
    """

    mass_kg: Positive
    volume_m3: Positive
    inertia: InertiaRecord
    area_m2: Positive
    span_m: Positive
    chord_m: Positive
    law: BoardLawRecord | None = None
    coefficients: CoefficientsRecord
    rotary_slope: NotNegative
    fastening: FasteningRecord
    installation: InstallationRecord = InstallationRecord()
    added_mass_kg: tuple[NotNegative, NotNegative, NotNegative]

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


def _refuse_keys_of_0_1(given: dict[str, object]) -> None:
    found = [key for key in ('force_axes', 'moment_signs', 'slip_sign') if key in given]
    if found:
        raise ValueError(
            f'found {", ".join(found)} of a gear file of 0.1, expected none: loads act in one '
            'frame now, aft, outward and down (docs/from_0_1.md). Delete these keys and run '
            'trawl trim; or, to keep what force_axes: flow, moment_signs: [-1, 1, 1] and '
            'slip_sign: -1 did, reverse the signs of c3, b5, a6 and c6'
        )


def plate_inertia(mass: float, volume: float, span: float, chord: float) -> dict[str, float]:
    """Inertia (kg m²) of an even plate, as thick as its volume (m³) makes it."""
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
    """Added mass (kg) of a rectangular plate across its face: strips, corrected after Pabst."""
    aspect = max(span, chord) / min(span, chord)
    strips = SEA * pi / 4 * min(span, chord) ** 2 * max(span, chord)
    return strips * aspect / sqrt(1 + aspect**2) * (1 - 0.425 * aspect / (1 + aspect**2))


CORRECTIONS = StartRecord(
    start=(0.0,) * 12,
    std=(0.3, 0.05, 0.5, 0.2, 0.3, 0.05, 0.2, 0.1, 0.3, 0.05, 0.3, 0.15),
    low=(-2.0, -0.3, -2.0, -1.0, -2.0, -0.5, -2.0, -0.5, -1.0, -0.5, -2.0, -0.5),
    high=(2.0, 0.3, 2.0, 1.0, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5, 2.0, 0.5),
)
"""Prior of the corrections to a board's law, where the gear file states none; assumed."""
