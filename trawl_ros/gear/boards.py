# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Records of the otter board: its plate, and its law with the values of its parameters."""

from itertools import pairwise
from math import pi, sqrt
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.board_parameters import (
    PARAMETERS_OF_KIND,
    BoardParameters,
    CoefficientsRecord,
)
from trawl_ros.gear.numbers import Degrees, NotNegative, Positive, Vector

SEA_DENSITY_KG_M3 = 1025.0
"""Density of the water in the added mass of a plate."""


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
    """Law of a board in place of eq. 14.

    A ``table`` has points of a flume tank, or those of a ``door`` of the catalogue. A ``foil``
    computes them for a cambered board that stalls at ``stall_deg`` with the lift ``max_lift``. The
    straight lines of eq. 14 are added to both. A table may have ``heel`` and ``trim``, which
    replace those of its door. ``heel`` is eq. 14 with lift against heel, ``stall`` a polar with
    stall; both have nothing but their parameters.
    """

    kind: Literal['table', 'foil', 'heel', 'stall']
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
        if self.kind in ('heel', 'stall') and (extra := self.model_fields_set - {'kind'}):
            raise ValueError(f'found {", ".join(sorted(extra))}, expected kind alone')
        if self.kind == 'foil' and (given or self.heel or self.trim):
            raise ValueError('found door, points, heel or trim, expected none of them for a foil')
        if self.kind == 'foil' and (self.max_lift is None or self.stall_deg is None):
            raise ValueError('max_lift or stall_deg: missing, expected both for a foil')
        _rising(self.points)
        _tilts_rise(heel=self.heel, trim=self.trim)
        return self


class BoardRecord(Record):
    """Otter board; the starboard board is the mirror image of the port board.

    Inertia and added mass are those of a plate of this span and chord by default. The coefficients
    are the parameters of the ``law``, eq. 14 if there is none.
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
    """Parameters of the `law`; needed without one and for `heel`, else its defaults."""
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
        own = parameters_of(given.get('law'))
        if given.get('law') is not None:
            given.setdefault('rotary_slope', 2.5)
        if own.prior is not None:
            given.setdefault('coefficients', own.start)
        if isinstance(given.get('coefficients'), dict):
            given['coefficients'] = own.ordered(given['coefficients'])
        return given

    @property
    def parameters(self) -> BoardParameters:
        """Parameters of the board's law."""
        return parameters_of(self.law)

    @model_validator(mode='after')
    def _values_of_parameters(self) -> 'BoardRecord':
        if faults := list(self.parameters.faults_of_values(self.coefficients)):
            raise ValueError('\n'.join(faults))
        return self


def parameters_of(law: object) -> BoardParameters:
    """Return the parameters of a law, a record or the content of a file; of eq. 14 without any."""
    kind = law.get('kind') if isinstance(law, dict) else getattr(law, 'kind', 'eq14')
    return PARAMETERS_OF_KIND.get(str(kind), PARAMETERS_OF_KIND['eq14'])


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
