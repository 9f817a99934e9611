"""Input file of MoorDyn from records."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

DEEP = 3000.0
"""Depth of water (m) at which nothing touches the bottom."""


@dataclass(frozen=True)
class LineType:
    """Line type, in MoorDyn's terms.

    ``diameter`` (m) of the displaced volume; ``mass`` in air (kg/m); ``stiffness`` EA (N);
    ``damping`` BA (N s), or a negative share of critical damping; drag across on the diameter,
    along on π d; added mass across and along as shares of the displaced mass.
    """

    diameter: float
    mass: float
    stiffness: float
    damping: float
    drag: float
    added: float
    drag_along: float
    added_along: float = 0.0


@dataclass(frozen=True)
class Point:
    """Point: ``coupled`` ones are moved from outside, ``free`` ones by forces.

    ``place`` (3,) in m with z up from the surface, ``mass`` kg, ``volume`` m³, ``drag_area``
    C_D A in m², ``added`` mass as a share of the displaced mass.
    """

    kind: Literal['coupled', 'free']
    place: Sequence[float]
    mass: float = 0.0
    volume: float = 0.0
    drag_area: float = 0.0
    added: float = 0.0


@dataclass(frozen=True)
class Line:
    """Line between two points.

    Attributes
    ----------
    kind
        Index of its line type, from 0.
    start, end
        Indices of its points, from 0.
    length
        Unstretched length, m.
    segments
        Number of segments.
    """

    kind: int
    start: int
    end: int
    length: float
    segments: int


@dataclass(frozen=True)
class Options:
    """Solver options of MoorDyn, and the water.

    Attributes
    ----------
    scheme
        MoorDyn's name of the time scheme.
    step
        Time step, s.
    density, gravity
        In kg/m³ and m/s².
    """

    scheme: str
    step: float
    density: float = 1025.0
    gravity: float = 9.80665


def input_file(
    kinds: Sequence[LineType], points: Sequence[Point], lines: Sequence[Line], options: Options
) -> str:
    """Text of an input file (version 2)."""
    return '\n'.join(
        [
            '--- MoorDyn ---',
            '--- LINE TYPES ---',
            'Name Diam Mass EA BA EI Cd Ca CdAx CaAx',
            '(-) (m) (kg/m) (N) (N-s) (N-m2) (-) (-) (-) (-)',
            *(
                f'kind{k} {t.diameter!r} {t.mass!r} {t.stiffness!r} {t.damping!r} 0 {t.drag!r} '
                f'{t.added!r} {t.drag_along!r} {t.added_along!r}'
                for k, t in enumerate(kinds)
            ),
            '--- POINTS ---',
            'ID Type X Y Z Mass Volume CdA Ca',
            '(-) (-) (m) (m) (m) (kg) (m3) (m2) (-)',
            *(
                f'{k} {p.kind} {" ".join(f"{float(x)!r}" for x in p.place)} {p.mass!r} '
                f'{p.volume!r} {p.drag_area!r} {p.added!r}'
                for k, p in enumerate(points, 1)
            ),
            '--- LINES ---',
            'ID Kind EndA EndB Length Segments Outputs',
            '(-) (-) (-) (-) (m) (-) (-)',
            *(
                f'{k} kind{n.kind} {n.start + 1} {n.end + 1} {n.length!r} {n.segments} -'
                for k, n in enumerate(lines, 1)
            ),
            '--- OPTIONS ---',
            '0 writeLog',
            f'{options.step!r} dtM',
            f'{options.scheme} tScheme',
            f'{options.density!r} rho',
            f'{options.gravity!r} g',
            f'{DEEP!r} WtrDpth',
            '1 disableOutput',
            '1 disableOutTime',
            '--- END ---',
            '',
        ]
    )
