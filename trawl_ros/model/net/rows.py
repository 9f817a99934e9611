# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Netting along its length: the profile of the real netting, and the rows of grouped bars."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.limits import GEAR_NODES
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.model.net.wake import bar_angle, exposure, viscous

LEAST_ROWS = 3
"""Least number of rows, so that the top has two nodes for the kite's carrying points."""


@dataclass(frozen=True)
class NettingRow:
    """Row of bars over the stretched distances ``front`` to ``back`` (m) from the mouth.

    Its front edge has ``around`` nodes; those of an odd edge (``odd``) begin half a pitch from the
    top. If it ``joins`` meshes, two of them at a time are tied to one of the ``around / 2`` nodes
    of the back edge. A ``straight`` row ties each node to the one behind it by a single bar.
    """

    front: float
    back: float
    around: int
    odd: bool
    joins: bool
    straight: bool = False

    @property
    def rest(self) -> float:
        """Unstretched length of the bars, m."""
        return self.back - self.front

    @property
    def in_wing(self) -> bool:
        """True for a row ahead of the mouth, with a margin for rounding."""
        return self.back <= 1e-9

    @property
    def columns(self) -> int:
        """Number of real meshes around, of two bars each, that the row's bars stand for."""
        return self.around // 2 if self.joins else self.around


class Profile:
    """Real netting as functions of the stretched distance from its front.

    Sections are those of a body, or of a codend, which is ``closed`` behind.
    """

    def __init__(
        self, sections: tuple[SectionRecord, ...], net: NettingRecord, *, closed: bool = False
    ) -> None:
        self.sections, self.net = sections, net
        self.edges: list[float] = np.cumsum([0.0, *(s.length_m for s in sections)]).tolist()
        closing = sections[-1].back_circumference_m / self.length if closed else 0.0
        self._exposures = {id(s): exposure(s, net, closing) for s in sections}

    @property
    def length(self) -> float:
        """Stretched length of the netting, m."""
        return self.edges[-1]

    def at(self, x: float) -> tuple[SectionRecord, float]:
        """Return the section at ``x`` and its stretched circumference there."""
        k = min(max(bisect_right(self.edges, x) - 1, 0), len(self.sections) - 1)
        s = self.sections[k]
        share = max(x - self.edges[k], 0.0) / s.length_m
        return s, s.front_circumference_m + share * (
            s.back_circumference_m - s.front_circumference_m
        )

    def per_mesh_column(self, front: float, back: float, around: int) -> dict[str, float]:
        """Return sums over [front, back] per bar, for two bars in each of ``around`` meshes.

        Netting ahead of the mouth is taken to be the same as at the mouth. All sums are linear in
        the circumference, so the value at the middle of each piece is exact.
        """
        sums = 'area', 'width', 'volume', 'mass', 'stiffness', 'knots', 'knot_volume'
        # The last four are weighted by the exposure of the sheet.
        total = dict.fromkeys((*sums, 'normal', 'sliding', 'lift', 'knot_root'), 0.0)
        for section, parallel, dx in self._pieces(front, back, around):
            left, d = self._exposures[id(section)], section.twine_diameter_m
            twine, area = np.pi / 4 * d**2, parallel * d * dx
            total['area'] += area
            total['normal'] += area * left.normal
            total['sliding'] += area * left.friction
            total['lift'] += area * left.lift
            total['width'] += d * dx
            total['volume'] += parallel * twine * dx
            total['mass'] += parallel * twine * section.twine_density_kg_m3 * dx
            bearing = 0.5 * parallel if section.square else parallel
            total['stiffness'] += bearing * twine * section.twine_modulus_pa * dx
            # Two knots per mesh and mesh length, shared by the two bars of a column.
            knots = 0.0 if section.knotless else parallel / (section.mesh_m / 2) * dx / 2
            total['knots'] += knots * np.pi / 4 * d**2 * left.knots
            total['knot_root'] += knots * np.pi / 4 * d**1.5 * left.knots
            total['knot_volume'] += knots * np.pi / 6 * d**3
        return total

    def _pieces(
        self, front: float, back: float, around: int
    ) -> Iterator[tuple[SectionRecord, float, float]]:
        """Yield the sections of [front, back], each with its bars side by side and its length (m).

        The number of bars is the mean over the length.
        """
        cuts = [front, *(edge for edge in self.edges if front < edge < back), back]
        for start, end in pairwise(cuts):
            section, circumference = self.at(0.5 * (start + end))
            # Square meshes have a bar along and one across for each bar's length.
            bars = section.twines * (2.0 if section.square else 1.0)
            yield section, circumference / section.mesh_m / around * bars, end - start

    def line_drag(self, front: float, back: float) -> tuple[float, float]:
        """Return drag area C_D S (m²) of the twines over [front, back], and its viscous part.

        The latter is in m² √(m/s). Both are those of `lump_pass`, for bars at the mesh angle.
        """
        net, area, viscous_area = self.net, 0.0, 0.0
        for section, parallel, dx in self._pieces(front, back, 1):
            left, d = self._exposures[id(section)], section.twine_diameter_m
            # Two bars make a mesh.
            twine = 2.0 * parallel * d * dx
            angle = bar_angle(section, net)
            angles = np.array([0.0, 0.5 * np.pi] if section.square else [angle])
            sine, cosine = np.sin(angles), np.abs(np.cos(angles))
            normal = net.normal_drag * left.normal
            friction = np.pi * net.friction * left.friction
            growth = viscous(net, d)
            area += twine * np.mean(normal * sine**3 + friction * cosine**3)
            viscous_area += twine * np.mean(
                growth[0] * normal * sine**2.5 + growth[1] * friction * np.sqrt(sine) * cosine**2
            )
        return float(area), float(viscous_area)


def rows_of(
    profile: Profile, around: int, halved_at: tuple[float, ...], corner: int
) -> tuple[NettingRow, ...]:
    """Return rows whose lengths make ``around`` meshes as wide as the real ones.

    The last row ends with the body and has 0.5 to 1.5 times its regular length.

    Parameters
    ----------
    profile
        Profile of the body.
    around
        Numerical meshes around the mouth.
    halved_at
        Stretched circumferences (m), falling, below which half as many meshes go around.
    corner
        Half pitches from the middle of the upper or lower panel to the corner between wing and
        bosom. There the frame rope transfers much of its tension to one line of bars. Joining
        meshes ends every second line, so they are joined on rows where this line continues.

    Raises
    ------
    GearError
        If there are more nodes than `GEAR_NODES` allows, or too few rows to carry a kite.
    """
    rows = _of_ropes(profile, around)
    ropes, nodes = len(rows), around * len(rows)
    x, line, odd, pending = rows[-1].back if rows else 0.0, corner, False, list(halved_at)
    while x < profile.length:
        _, circumference = profile.at(x)
        # The circumference shrinks along the row: use the one at its middle.
        _, middle = profile.at(min(x + circumference / (4 * around), profile.length))
        end = x + middle / (2 * around)
        last = profile.length - x < 1.5 * (end - x)
        nodes += around
        if nodes > GEAR_NODES.value:
            raise _too_fine(profile, end - x)
        due = bool(pending) and circumference <= pending[0] and around % 2 == 0
        # Lines of nodes with an even number (here ``line // 2``) continue.
        joins = due and line % 4 == 1 and not last
        rows.append(NettingRow(x, profile.length if last else end, around, odd, joins))
        x, line, odd = rows[-1].back, line - 1, not odd
        if joins:
            around, line, odd = around // 2, line // 2, False
            del pending[0]
    if len(rows) - ropes < LEAST_ROWS:
        behind = profile.length - (rows[ropes - 1].back if ropes else 0.0)
        raise GearError(
            f'netting.body: found {len(rows) - ropes} rows of the mesh in {behind:g} m of netting, '
            f'expected at least {LEAST_ROWS}; use more meshes around or a longer body'
        )
    return tuple(rows)


def _of_ropes(profile: Profile, around: int) -> list[NettingRow]:
    """Return the rows of ropes ahead of the netting, about as long as rows of netting."""
    rows: list[NettingRow] = []
    for section, front, back in zip(profile.sections, profile.edges, profile.edges[1:]):
        if not section.ropes:
            break
        length = section.front_circumference_m / (2 * around)
        number = max(1.0, round(section.length_m / length))
        if number * around > GEAR_NODES.value:
            raise _too_fine(profile, length)
        edges = np.linspace(front, back, int(number) + 1).tolist()
        rows += [
            NettingRow(start, end, around, odd=False, joins=False, straight=True)
            for start, end in pairwise(edges)
        ]
    return rows


def _too_fine(profile: Profile, row: float) -> GearError:
    return GearError(
        f'netting.body: found more than {GEAR_NODES} in {profile.length:g} m with rows of '
        f'{row:g} m, expected fewer meshes around or a shorter body'
    )
