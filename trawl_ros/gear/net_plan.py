# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Net plan: pieces of netting as on a paper plan, one row of a table each."""

import re
from typing import Annotated, Literal

from pydantic import Field, model_validator

from trawl_ros.core.schema import Record
from trawl_ros.gear.twine import Material, Twine, twine_of

Part = Literal['wing', 'body', 'codend']
Panel = Literal['upper', 'lower', 'side', 'side_upper', 'side_lower', 'all']
Orientation = Literal['T0', 'T90', 'square', 'ropes']
Meshes = Annotated[float, Field(ge=0, le=100_000)]

WING_PANELS = ('upper', 'lower', 'side', 'side_upper', 'side_lower')
BODY_PANELS = ('upper', 'lower', 'side', 'side_upper', 'side_lower', 'all')

SIDES = ('side', 'side_upper', 'side_lower')
"""Panels that a net has at port and at starboard."""

_CUT = re.compile(r'(?:A([BNT])|(?:(\d+)([NT]))?(?:(\d+)B)?)')


def cut_slope(cut: str) -> float:
    """Return the slope of an edge of this cutting rate: meshes across per mesh along.

    A bar (B) is half a mesh along and half a mesh across, a point (N) one along, a mesh (T) one
    across: ``AB`` gives 1, ``1N2B`` gives 0.5, ``AN`` gives 0.

    Raises
    ------
    ValueError
        If it is no cutting rate, or has no length along.
    """
    found = _CUT.fullmatch(cut.replace(' ', '').upper())
    if found is None or not cut.strip():
        raise ValueError(f"found '{cut}', expected a cutting rate such as AB, AN, 1N2B or 1T2B")
    whole, count, kind, bars = found.groups()
    if whole is not None:
        count, kind, bars = (None, None, '1') if whole == 'B' else ('1', whole, None)
    straight, slanted = float(count or 0), 0.5 * float(bars or 0)
    along = slanted + (straight if kind == 'N' else 0.0)
    across = slanted + (straight if kind == 'T' else 0.0)
    if along <= 0.0:
        raise ValueError(f"found '{cut}', expected a cut with bars or points")
    return across / along


class PieceRecord(Record):
    """Piece of netting: counts of meshes across its front and back edge, and along it.

    Counts of a ``wing`` are those of one of its two pieces; with ``pieces`` 1 the wing is a panel
    that continues forward over its whole width. Counts of ``all`` are those of the whole
    circumference. If one edge has no count, it follows from the ``cut``. ``square`` meshes are
    counted by their bars. For ``ropes`` in place of meshes, counts across are numbers of ropes, and
    ``mesh_mm`` is the length of frame per rope.
    """

    part: Part
    """Part of the net."""
    panel: Panel
    """Panel; `all` is what goes all around, `side_upper` and `side_lower` are two panels or
    wings of a side.
    """
    section: str = ''
    """Pieces of the body with one name lie side by side and are equally long."""
    mesh_mm: Annotated[float, Field(ge=2, le=200_000)]
    """Stretched mesh; of `ropes`, the length of frame per rope."""
    front_meshes: Meshes
    """Meshes across the front edge of one panel, of one wing, or all around; needed without a
    `cut`.
    """
    back_meshes: Meshes
    """The same at the back edge; needed without a `cut`."""
    long_meshes: Annotated[float, Field(gt=0, le=100_000)]
    """Meshes along."""
    rtex: Annotated[float, Field(gt=0, le=1e7)] | None = None
    """Mass of the twine, g/km; this or the diameter is needed."""
    twine_diameter_mm: Annotated[float, Field(gt=0, le=100)] | None = None
    """Diameter of the twine."""
    material: Material
    """Fibre."""
    knots: Literal['knotted', 'knotless'] = 'knotted'
    """Knots."""
    twines: Literal[1, 2] = 1
    """Twines in each bar."""
    pieces: Literal[1, 2] | None = None
    """1 for a wing that is one piece over the whole panel and reaches ahead of the others."""
    cut: str | None = None
    """Cutting rate, such as AB, AN, 1N2B or 1T2B. It gives the count of an edge that is left
    out, else is checked.
    """
    orientation: Orientation = 'T0'
    """Way of the meshes. Square meshes are counted by their bars, `ropes` by their number."""

    @model_validator(mode='before')
    @classmethod
    def _counted(cls, data: object) -> object:
        """Compute the count of a missing edge from the cut and the other edge."""
        if not isinstance(data, dict) or not isinstance(data.get('cut'), str):
            return data
        long, part = data.get('long_meshes'), data.get('part')
        known = [key for key in ('front_meshes', 'back_meshes') if key in data]
        numbers = [data.get(key) for key in ('long_meshes', *known)]
        if len(known) != 1 or not all(isinstance(x, int | float) for x in numbers):
            return data
        # A wing's seam runs straight, its other edge is cut; a panel is cut on both.
        lost = (1 if part == 'wing' else 2) * cut_slope(data['cut']) * float(long or 0)
        front = 'front_meshes' in data
        # Wings widen and bodies narrow toward the codend.
        sign = 1 if (part == 'wing') == front else -1
        other = 'back_meshes' if front else 'front_meshes'
        return {**data, other: max(float(data[known[0]]) + sign * lost, 0.0)}

    @model_validator(mode='after')
    def _whole(self) -> 'PieceRecord':
        if self.rtex is None and self.twine_diameter_mm is None:
            raise ValueError('found neither rtex nor twine_diameter_mm, expected one of them')
        allowed = WING_PANELS if self.part == 'wing' else BODY_PANELS
        if self.panel not in allowed:
            raise ValueError(f'panel: found {self.panel}, expected one of {", ".join(allowed)}')
        if self.orientation == 'square' and (self.part == 'wing' or self.panel != 'all'):
            raise ValueError(
                f'orientation: found square in the {self.panel} {self.part}, expected T0 or T90: '
                'square meshes are modelled in the codend and in sections ahead of it that have '
                'one panel (all)'
            )
        if self.orientation == 'ropes' and (
            self.part != 'body' or self.front_meshes != self.back_meshes
        ):
            raise ValueError(
                f'orientation: found ropes in a {self.part}, {self.front_meshes:g} at its front '
                f'and {self.back_meshes:g} at its back, expected equal numbers of ropes in the body'
            )
        if self.cut is not None:
            try:
                cut_slope(self.cut)
            except ValueError as reason:
                raise ValueError(f'cut: {reason}') from reason
        return self

    @property
    def mesh(self) -> float:
        """Stretched length of a mesh, m."""
        return 1e-3 * self.mesh_mm

    @property
    def pitch(self) -> float:
        """Distance (m) per count: a stretched mesh, or the bar of a square mesh."""
        return self.mesh if self.orientation != 'square' else 0.5 * self.mesh

    @property
    def length(self) -> float:
        """Stretched length of the piece, m."""
        return self.pitch * self.long_meshes

    @property
    def widths(self) -> tuple[float, float]:
        """Stretched widths (m) of the front and the back edge."""
        return self.pitch * self.front_meshes, self.pitch * self.back_meshes

    @property
    def twine(self) -> Twine:
        """Twine of the piece."""
        diameter = None if self.twine_diameter_mm is None else 1e-3 * self.twine_diameter_mm
        return twine_of(self.material, self.rtex, diameter)

    @property
    def count(self) -> int:
        """Number of such pieces in the net."""
        if self.part != 'wing':
            return 2 if self.panel in SIDES else 1
        if self.panel in ('side_upper', 'side_lower'):
            return 2
        # One whole side panel on either side; two wings of the upper or the lower panel.
        return 2 if self.panel == 'side' else self.pieces or 2

    @property
    def twine_length(self) -> float:
        """Length of twine or ropes (m) in all such pieces.

        A diamond mesh has twine of twice its length, a square mesh two bars.
        """
        if self.orientation == 'ropes':
            return self.front_meshes * self.length * self.twines * self.count
        meshes = 0.5 * (self.front_meshes + self.back_meshes) * self.long_meshes
        return 2 * self.pitch * meshes * self.twines * self.count

    @property
    def twine_area(self) -> float:
        """Area of this twine, length times diameter, m²."""
        return self.twine_length * self.twine.diameter

    @property
    def mass(self) -> float:
        """Mass of this twine in air without its knots, kg."""
        return self.twine_length * self.twine.tex


class HangingRecord(Record):
    """Hanging ratios: rope over stretched netting, along bosoms, wing edges and wing tips.

    Wing edges take the remainder of a rope of given length; without a length they have the ratio
    ``wing_edge``.
    """

    bosom: Annotated[float, Field(gt=0.1, le=1)] = 0.5
    """Rope over stretched netting along the bosom."""
    wing_edge: Annotated[float, Field(gt=0.3, le=1)] = 0.96
    """The same along the wing edges, unless the rope has a length."""
    wing_tip: Annotated[float, Field(gt=0, le=1)] = 0.3
    """The same across the gathered wing tip."""


class NetPlanRecord(Record):
    """Net plan: pieces from the wings to the codend, in the order of the plan.

    Pieces of the body with the same ``section`` lie side by side and have one length. Pieces of one
    panel's wing, and sections of the codend, follow each other. Without ``shielded`` all netting
    has the drag of its single twines and knots.
    """

    hanging: HangingRecord = HangingRecord()
    """Hanging ratios of the ropes."""
    shielded: bool = True
    """False leaves all drag of single twines and knots."""
    pieces: Annotated[tuple[PieceRecord, ...], Field(min_length=2, max_length=200)]
    """Pieces, from the wings to the codend."""

    @model_validator(mode='after')
    def _joins(self) -> 'NetPlanRecord':
        parts: tuple[Part, ...] = 'body', 'codend'
        for part in parts:
            if not self.sections(part):
                raise ValueError(f'pieces: found no {part}, expected at least one piece of it')
        for part in parts:
            for name, pieces in self.sections(part):
                panels = sorted(piece.panel for piece in pieces)
                if panels not in (
                    ['all'],
                    ['lower', 'upper'],
                    ['lower', 'side', 'upper'],
                    ['lower', 'side_lower', 'side_upper', 'upper'],
                ):
                    raise ValueError(
                        f"pieces: section '{name}' has the panels {', '.join(panels)}, expected "
                        'all, or upper and lower once each, with side, with side_upper and '
                        'side_lower, or with neither'
                    )
                if (around := sum(piece.front_meshes for piece in pieces)) < 1:
                    raise ValueError(
                        f"pieces: section '{name}' has {around:g} front_meshes in all its panels, "
                        'expected 1 or more'
                    )
                long = [piece.length for piece in pieces]
                if max(long) > 1.03 * min(long):
                    raise ValueError(
                        f"pieces: panels of section '{name}' are {min(long):g} to {max(long):g} m "
                        'long, expected one length'
                    )
        behind_netting = False
        for name, pieces in self.sections('body'):
            ropes = {piece.orientation == 'ropes' for piece in pieces}
            if len(ropes) > 1 or (behind_netting and True in ropes):
                raise ValueError(
                    f"pieces: section '{name}' has ropes next to or behind netting, expected ropes "
                    'in all of its panels and in all sections ahead of it'
                )
            behind_netting |= False in ropes
        if not behind_netting:
            raise ValueError(
                'pieces: found no netting behind the ropes, expected at least one piece'
            )
        for panel in ('upper', 'lower'):
            if not self.wing(panel):
                raise ValueError(f'pieces: found no wing of the {panel} panel, expected one')
        if self.panels == ('all',) and any(p.part == 'wing' for p in self.pieces):
            raise ValueError(
                'pieces: found one panel (all) in the foremost section, expected upper and lower '
                'panels, to which the wings are joined'
            )
        return self

    def sections(self, part: Part) -> list[tuple[str, list[PieceRecord]]]:
        """Return the sections of body or codend, from front to back, with the pieces of each."""
        found: dict[str, list[PieceRecord]] = {}
        for number, piece in enumerate(self.pieces):
            if piece.part == part:
                # Each piece without a section name is a section.
                found.setdefault(piece.section or f'{part} {number + 1}', []).append(piece)
        return list(found.items())

    @property
    def panels(self) -> tuple[str, ...]:
        """Panels at the mouth; ``('all',)`` if there is one piece."""
        return tuple(piece.panel for piece in self.sections('body')[0][1])

    def mouth_width(self, panel: str) -> float:
        """Return the stretched width (m) of a panel at the mouth; 0 if there is none.

        The width of a ``side`` with two panels is their sum.
        """
        names = SIDES if panel == 'side' else (panel,)
        return sum(p.widths[0] for p in self.sections('body')[0][1] if p.panel in names)

    @property
    def circumference(self) -> float:
        """Stretched circumference of the mouth, m."""
        return sum(piece.count * piece.widths[0] for piece in self.sections('body')[0][1])

    def wing(self, panel: str) -> list[PieceRecord]:
        """Return the pieces of a panel's wing, from the mouth forward."""
        return [p for p in self.pieces if p.part == 'wing' and p.panel == panel][::-1]

    @property
    def open_side(self) -> bool:
        """True if the sides are cut out between upper and lower wings."""
        return not set(SIDES).isdisjoint(self.panels) and not self.wing('side')

    def hung_netting(self, rope: str) -> dict[str, float]:
        """Return the stretched netting (m) that hangs on a rope of the frame, by kind.

        Parameters
        ----------
        rope
            ``headrope``, ``footrope`` or ``side_rope`` (of one side).

        Returns
        -------
        dict
            ``edge`` along the cut edges of wings, ``bosom`` between them, ``tip`` across the ends
            of the wings up to where bridles are shackled.
        """
        if rope != 'side_rope':
            panel = 'upper' if rope == 'headrope' else 'lower'
            whole = [piece for piece in self.wing(panel) if piece.pieces == 1]
            cut = [piece for piece in self.wing(panel) if piece.pieces != 1]
            width = whole[-1].widths[0] if whole else self.mouth_width(panel)
            gap = width - 2 * (cut[0].widths[1] if cut else 0.0)
            tip = cut[-1].widths[0] if cut and self.open_side else 0.0
            edge = sum(piece.length for piece in cut)
            return {'edge': 2 * edge, 'bosom': max(gap, 0.0), 'tip': 2 * tip}
        if not self.open_side:
            names = [name for name in ('upper', 'side', 'lower') if self.wing(name)]
            return {
                'edge': 0.0,
                'bosom': 0.0,
                'tip': sum(self.wing(name)[-1].widths[0] for name in names),
            }
        wings = [self.wing(name) for name in ('side_upper', 'side_lower')]
        gap = self.mouth_width('side') - sum(wing[0].widths[1] for wing in wings if wing)
        return {
            'edge': sum(self.wing_length(name) for name in ('upper', 'lower')),
            'bosom': max(gap, 0.0),
            'tip': sum(wing[-1].widths[0] for wing in wings if wing),
        }

    def rope_length(self, rope: str) -> float:
        """Return the length (m) of a rope of the frame by the hanging ratios."""
        netting, ratios = self.hung_netting(rope), self.hanging
        return (
            ratios.wing_edge * netting['edge']
            + ratios.bosom * netting['bosom']
            + ratios.wing_tip * netting['tip']
        )

    def wing_length(self, panel: str) -> float:
        """Return the stretched length of a panel's wing, m."""
        return sum(piece.length for piece in self.wing(panel))
