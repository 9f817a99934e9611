"""Netting along its length: the profile of the real one, and the rows of bars grouped from it."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.core.limits import GEAR_NODES
from trawl_ros.gear.netting import NettingRecord, SectionRecord
from trawl_ros.model.net.twine_drag import viscous
from trawl_ros.model.net.wake import bar_angle, exposure

SLICES = 64
"""Slices along a row over which the sections' properties are summed."""

LEAST_ROWS = 3
"""So that the top has two nodes for the kite's carrying points."""


@dataclass(frozen=True)
class NettingRow:
    """A row of bars over the stretched distances ``front`` to ``back`` (m) from the mouth.

    ``around`` nodes are on its front edge, those of an odd edge (``odd``) half a pitch further
    than the top. With ``joins`` each two of them are tied to one of the ``around / 2`` nodes of
    the back edge. Those of a ``straight`` row are tied to the one behind them, by a single bar.
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
    def columns(self) -> int:
        """Number of real meshes around, of two bars each, that the row's bars stand for."""
        return self.around // 2 if self.joins else self.around


class Profile:
    """Real netting as functions of the stretched distance from the mouth, or that of a codend,
    which is ``closed`` behind.
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

    def behind(self, x: float) -> tuple[SectionRecord, ...]:
        """Sections behind ``x``, the first one cut there."""
        left = []
        for section, front, back in zip(self.sections, self.edges, self.edges[1:], strict=False):
            if back > x:
                start = max(x, front)
                _, circumference = self.at(start)
                changes = {'length_m': back - start, 'front_circumference_m': circumference}
                left.append(section.model_copy(update=changes))
        return tuple(left)

    def at(self, x: float) -> tuple[SectionRecord, float]:
        """Section at ``x`` and its stretched circumference there."""
        k = min(max(bisect_right(self.edges, x) - 1, 0), len(self.sections) - 1)
        s = self.sections[k]
        share = max(x - self.edges[k], 0.0) / s.length_m
        return s, s.front_circumference_m + share * (
            s.back_circumference_m - s.front_circumference_m
        )

    def per_mesh_column(self, front: float, back: float, around: int) -> dict[str, float]:
        """Sums over [front, back] per bar, for two bars in each of ``around`` meshes.

        Netting ahead of the mouth is taken to be like that at the mouth.
        """
        sums = 'area', 'width', 'volume', 'mass', 'stiffness', 'knots', 'knot_volume'
        # Of the area what is left of the drag of single twines across them, and along.
        total = dict.fromkeys((*sums, 'normal', 'sliding', 'lift', 'knot_root'), 0.0)
        dx = (back - front) / SLICES
        for section, parallel in self._slices(front, back, around):
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

    def _slices(
        self, front: float, back: float, around: int
    ) -> Iterator[tuple[SectionRecord, float]]:
        """Sections in the middles of slices of [front, back], and bars side by side there."""
        dx = (back - front) / SLICES
        for x in front + (np.arange(SLICES) + 0.5) * dx:
            section, circumference = self.at(float(x))
            # Square meshes have a bar along and one across for each bar's length.
            bars = section.twines * (2.0 if section.square else 1.0)
            yield section, circumference / section.mesh_m / around * bars

    def line_drag(self, front: float, back: float) -> tuple[float, float]:
        """Drag area C_D S (m²) of the twines over [front, back] as they lie in the flow, and its
        viscous part (m² √(m/s)), both as `lump_pass` has them.
        """
        net, area, viscous_area = self.net, 0.0, 0.0
        for section, parallel in self._slices(front, back, 1):
            left, d = self._exposures[id(section)], section.twine_diameter_m
            # Two bars make a mesh.
            twine = 2.0 * parallel * d * (back - front) / SLICES
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


def rows_of(profile: Profile, around: int, halved_at: tuple[float, ...]) -> tuple[NettingRow, ...]:
    """Rows as long as makes ``around`` meshes as wide as the real ones, as many as fit into the
    body.

    Parameters
    ----------
    profile
        Of the body.
    around
        Numerical meshes around the mouth.
    halved_at
        Stretched circumferences (m), falling, below which half as many meshes go around.

    Raises
    ------
    GearError
        If they have more nodes than `GEAR_NODES` allows, or there are too few to carry a kite.
    """
    rows = _of_ropes(profile, around)
    ropes, nodes = len(rows), around * len(rows)
    x, odd, pending = rows[-1].back if rows else 0.0, False, list(halved_at)
    while True:
        _, circumference = profile.at(x)
        # The circumference shrinks along the row: use the one at its middle.
        _, middle = profile.at(min(x + circumference / (4 * around), profile.length))
        end = x + middle / (2 * around)
        if end > profile.length:
            break
        nodes += around
        if nodes > GEAR_NODES.value:
            raise _too_fine(profile, end - x)
        joins = bool(pending) and circumference <= pending[0] and odd and around % 2 == 0
        rows.append(NettingRow(x, end, around, odd, joins))
        x, odd = end, not odd
        if joins:
            around, odd = around // 2, False
            del pending[0]
    if len(rows) - ropes < LEAST_ROWS:
        behind = profile.length - (rows[ropes - 1].back if ropes else 0.0)
        raise GearError(
            f'netting.body: {behind:g} m of netting are {len(rows) - ropes} rows of the mesh, '
            f'expected at least {LEAST_ROWS}: more meshes around or more netting'
        )
    return tuple(rows)


def _of_ropes(profile: Profile, around: int) -> list[NettingRow]:
    """Rows of the ropes ahead of the netting, each about as long as one of netting would be."""
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
        f'netting.body: {profile.length:g} m in rows of {row:g} m have more than {GEAR_NODES}, '
        'expected fewer meshes around or less netting'
    )
