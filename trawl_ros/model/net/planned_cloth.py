# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Netting of a planned net at each place of it, panel by panel."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.schema import validated
from trawl_ros.gear.net_plan import NetPlanRecord, Panel, Part, PieceRecord
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.model.net.planned_mouth import PlannedMouth
from trawl_ros.model.net.rows import NettingRow, Profile

SEA_DENSITY_KG_M3 = 1025.0
"""Density of the water in the twines."""

MAX_BAR_ANGLE_RAD = np.radians(80.0)
"""Greatest angle at which knots hold the bars."""

LEAST_COLUMN_FRACTION = 0.3
"""Least part of its column that a bar at the edge of a wing has, so that it can bear a load."""

PANELS = ('upper', 'side_upper', 'side_lower', 'lower')
"""Panels from the top to the bottom; a side that is one piece is the upper of both."""


def mesh_angle(piece: PieceRecord, net: NettingRecord) -> float:
    """Return the angle (rad) of the bars of a piece against the flow, as in a codend.

    The knots of meshes turned by 90° lie across the flow and keep the bars apart: they are the
    third pair of sides of hexagons (Priour 2014, doi 10.1016/j.oceaneng.2014.09.037). A mesh of
    length m with knots of length k is m sin θ - 2k sin θ + 2k wide. Knotless meshes do not change.
    """
    angle = float(np.radians(net.codend_mesh_angle_deg))
    if piece.orientation != 'T90' or piece.knots == 'knotless':
        return angle
    knots = min(2 * net.knot_diameters * piece.twine.diameter / piece.mesh, 1.0)
    sine = np.sin(angle) + knots * (1.0 - np.sin(angle))
    return float(min(np.arcsin(sine), MAX_BAR_ANGLE_RAD))


def section_of(
    piece: PieceRecord, net: NettingRecord, length: float, front: float, back: float
) -> SectionRecord:
    """Return a piece as a section of the whole circumference, with its dimensions in m."""
    twine = piece.twine
    name = piece.section or piece.part
    angle = float(np.degrees(mesh_angle(piece, net))) if piece.orientation == 'T90' else None
    # The plan bounds its own numbers; what follows from them is bounded as any section is.
    derived = {
        'name': name,
        'length_m': length,
        'front_circumference_m': front,
        'back_circumference_m': max(back, 1e-6),
        'mesh_m': piece.mesh,
        'twine_diameter_m': twine.diameter,
        'twine_density_kg_m3': twine.density(SEA_DENSITY_KG_M3),
        'twine_modulus_pa': twine.fibre.modulus,
        'twines': piece.twines,
        'knotless': piece.knots == 'knotless' or piece.orientation == 'ropes',
        'shielding': None if net.plan is None or net.plan.shielded else 1.0,
        'mesh_angle_deg': angle,
        'square': piece.orientation == 'square',
        'ropes': piece.orientation == 'ropes',
    }
    return validated(SectionRecord, derived, f'netting.plan: {name}', GearError)


def sections_of(net: NettingRecord, plan: NetPlanRecord, part: Part, panel: str) -> Profile:
    """Return the profile of a part of the net, as if all of it had this panel's netting."""
    sections = []
    for _, pieces in plan.sections(part):
        front, back = (sum(p.count * p.widths[edge] for p in pieces) for edge in (0, 1))
        length = float(np.mean([piece.length for piece in pieces]))
        names = panel, 'side' if panel.startswith('side') else 'all', 'all'
        own = next((p for p in pieces if p.panel in names), pieces[0])
        sections.append(section_of(own, net, length, front, back))
    return Profile(tuple(sections), net)


@dataclass(frozen=True)
class PlannedCloth:
    """Netting of a planned net whose mouth is ``mouth``; ``known`` keeps sums already made."""

    net: NettingRecord
    mouth: PlannedMouth
    known: dict[tuple[str, NettingRow, int], dict[str, float]] = field(default_factory=dict)

    @property
    def plan(self) -> NetPlanRecord:
        """Plan of the net."""
        return self.mouth.plan

    @cached_property
    def bodies(self) -> dict[str, Profile]:
        """Profile of the body for the netting of each panel; their circumferences are the same."""
        return {panel: sections_of(self.net, self.plan, 'body', panel) for panel in PANELS}

    @cached_property
    def wings(self) -> dict[str, Profile]:
        """Netting ahead of the mouth for each panel, over the distance forward from it."""
        around, found = self.plan.circumference, {}
        for panel in PANELS:
            names: tuple[str, ...] = (panel,)
            if panel.startswith('side') and panel in self.plan.panels:
                names = panel, 'side', panel.removeprefix('side_')
            elif panel.startswith('side'):
                names = 'side_upper', 'side_lower', 'side', 'upper'
            pieces = next(pieces for name in names if (pieces := self.plan.wing(name)))
            sections = [section_of(p, self.net, p.length, around, around) for p in pieces]
            found[panel] = Profile(tuple(sections), self.net)
        return found

    def bounds(self, x: float) -> tuple[float, float, float]:
        """Return where the upper panel and both parts of the side end, at ``x`` m behind the mouth.

        They are parts of the circumference from the top. A side in one piece has an upper part
        only.
        """
        upper, lower, share = self._sides(x)
        return upper, lower if share == 1.0 else upper + share * (lower - upper), lower

    def _sides(self, x: float) -> tuple[float, float, float]:
        """Return the ends of upper panel and side, and the part of the side in its upper panel."""
        if x <= 0.0:
            upper, lower = self.mouth.seams
            around, side = 2 * self.mouth.around, self.plan.mouth_width('side')
            own = self.plan.mouth_width('side_upper')
            return upper / around, lower / around, own / side if own else 1.0
        for number, (_, pieces) in enumerate(self.plan.sections('body')):
            long = self.bodies['upper'].sections[number].length_m
            if x <= long or number == len(self.bodies['upper'].sections) - 1:
                share = min(x / long, 1.0)
                width = {p.panel: np.interp(share, (0.0, 1.0), p.widths) for p in pieces}
                whole = sum(p.count * width[p.panel] for p in pieces)
                if 'all' in width:
                    return self._last_sides(number)
                return _sides_of(width, whole)
            x -= long
        raise AssertionError

    def _last_sides(self, number: int) -> tuple[float, float, float]:
        """Return `_sides` at the end of the last section with panels, up to ``number``."""
        for _, pieces in self.plan.sections('body')[number::-1]:
            width = {p.panel: p.widths[1] for p in pieces}
            if 'all' not in width:
                return _sides_of(width, sum(p.count * p.widths[1] for p in pieces))
        return 0.25, 0.25, 1.0

    def sums(self, row: NettingRow, middle: float) -> dict[str, float]:
        """Return the sums of `Profile.per_mesh_column` for a bar of a row.

        Its middle lies at the part ``middle`` of the circumference from the top.
        """
        width = 1.0 / (row.around if row.joins or row.straight else 2 * row.around)
        place = min(middle % 1.0, 1.0 - middle % 1.0)
        x = 0.5 * (row.front + row.back)
        upper, middle_of_side, lower = self.bounds(x)
        low, high = place - 0.5 * width, place + 0.5 * width
        # The same panel continues beyond the top and the bottom.
        edges = -1.0, upper, middle_of_side, lower, 2.0
        cuts = dict(zip(PANELS, pairwise(edges), strict=True))
        shares = {
            panel: max(min(high, end) - max(low, start), 0.0) / width
            for panel, (start, end) in cuts.items()
        }
        if row.in_wing:
            wing = self.mouth.wing_at(2 * self.mouth.around * place)
            inside = self._inside(row, low, high)
            scale = max(inside, LEAST_COLUMN_FRACTION) / max(sum(shares.values()), 1e-12)
            shares = {panel: scale * share for panel, share in shares.items()}
        else:
            wing = 0
        total: dict[str, float] = {}
        for panel, share in shares.items():
            if share > 0.0:
                for key, value in self._column(panel, row, wing).items():
                    total[key] = total.get(key, 0.0) + share * value
        return total

    def _inside(self, row: NettingRow, low: float, high: float) -> float:
        """Return the part of [low, high] that wings cover in the middle of a row."""
        mouth, k = self.mouth, 0.5 * (row.front + row.back) / self.mouth.row
        whole, covered = 2 * mouth.around, 0.0
        for seam, rows, panels in (
            (mouth.seams[0], mouth.rows[0], ('upper', 'side_upper')),
            (mouth.seams[1], mouth.rows[1], ('side_lower', 'lower')),
        ):
            if -k <= rows:
                start = (seam - mouth.reach(panels[0], k)) / whole
                end = (seam + mouth.reach(panels[1], k)) / whole
                # A wing that reaches the middle of its panel continues beyond it.
                start, end = (-1.0 if start <= 0.0 else start), (2.0 if end >= 0.5 else end)
                covered += max(min(high, end) - max(low, start), 0.0)
        return min(covered / (high - low), 1.0)

    def _column(self, panel: str, row: NettingRow, wing: int) -> dict[str, float]:
        if (panel, row, wing) not in self.known:
            if row.in_wing:
                scale = self.mouth.scales[wing]
                front, back = -scale * row.back, -scale * row.front
                sums = self.wings[panel].per_mesh_column(front, back, row.columns)
            else:
                sums = self.bodies[panel].per_mesh_column(row.front, row.back, row.columns)
            self.known[panel, row, wing] = sums
        return self.known[panel, row, wing]


def _sides_of(width: Mapping[Panel, float], whole: float) -> tuple[float, float, float]:
    """Return the ends of upper panel and side, and the part of the side in its upper panel.

    The ends are parts of the whole circumference.
    """
    upper, lower = 0.5 * width['upper'] / whole, 0.5 - 0.5 * width['lower'] / whole
    own = width.get('side_upper')
    return upper, lower, 1.0 if own is None else own / (own + width['side_lower'])
