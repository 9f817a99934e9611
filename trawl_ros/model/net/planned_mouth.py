# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Mouth of a planned net: the nodes of its wings ahead of it, and its frame of ropes.

The angle of a node from the top is an integer number of half pitches, ``half`` in 0 … 2 ``around``,
even on even rows. Rows are counted from the mouth; those ahead of it are negative. Everything is
given for port; starboard is its mirror image. A wing is the netting on both sides of a seam: from
the upper seam inward to the headrope's bosom and outward to the side's, likewise from the lower.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import GearError
from trawl_ros.gear.net_plan import NetPlanRecord, PieceRecord

Place = tuple[int, int]
"""Row and half pitch of a node."""


@dataclass(frozen=True)
class FrameRope:
    """Rope along a rim of the net.

    ``places`` are those of its nodes. Each stretch between two nodes has the stretched ``netting``
    (m) along it and one of ``kinds``: ``edge``, ``bosom`` or ``tip``.
    """

    places: tuple[Place, ...]
    netting: tuple[float, ...]
    kinds: tuple[str, ...]

    def rests(self, plan: NetPlanRecord, length: float | None, name: str) -> FloatArray:
        """Return the rest lengths (n - 1,) of the stretches of a rope ``length`` m long.

        Without a length the hanging ratios determine it. Bosom and tips have the length of the
        plan for any number of stretches; wing edges have the remainder.

        Raises
        ------
        GearError
            If the rope is too short for its bosom and tips.
        """
        netting, hanging = plan.hung_netting(name), plan.hanging
        whole = plan.rope_length(name) if length is None else length
        hung = {'bosom': hanging.bosom * netting['bosom'], 'tip': hanging.wing_tip * netting['tip']}
        of = {
            kind: np.array([k == kind for k in self.kinds], dtype=bool)
            for kind in ('edge', 'bosom', 'tip')
        }
        if not of['edge'].any():
            hung = {kind: whole if of[kind].any() else 0.0 for kind in hung}
        left = whole - sum(hung[kind] for kind in hung if of[kind].any())
        if of['edge'].any() and left <= 0.0:
            raise GearError(
                f'{name}.length_m: found {whole:g}, expected more than the {whole - left:.4g} m '
                'that hang along bosom and wing tips'
            )
        rests: FloatArray = np.array(self.netting)
        for kind, rope in (*hung.items(), ('edge', left)):
            rests[of[kind]] *= rope / max(float(rests[of[kind]].sum()), 1e-12)
        return rests


@dataclass(frozen=True)
class PlannedMouth:
    """Mouth of a planned net of ``around`` meshes around, all of its rows ``row`` m long."""

    plan: NetPlanRecord
    around: int

    @property
    def row(self) -> float:
        """Stretched length of a row ahead of the mouth, m."""
        return self.plan.circumference / (2 * self.around)

    @cached_property
    def seams(self) -> tuple[float, float]:
        """Half pitches at which the upper and the lower panel end."""
        whole = 2 * self.around / self.plan.circumference
        upper = 0.5 * whole * self.plan.mouth_width('upper')
        return upper, self.around - 0.5 * whole * self.plan.mouth_width('lower')

    @cached_property
    def rows(self) -> tuple[int, int]:
        """Rows of the upper and of the lower wings."""
        long = (self.plan.wing_length(panel) for panel in ('upper', 'lower'))
        upper, lower = (max(1, round(length / self.row)) for length in long)
        return upper, lower

    @cached_property
    def scales(self) -> tuple[float, float]:
        """Row lengths of the upper and lower wings, over ``row``, that give the planned lengths."""
        long = (self.plan.wing_length(panel) for panel in ('upper', 'lower'))
        upper, lower = (length / (rows * self.row) for length, rows in zip(long, self.rows))
        return upper, lower

    def wing_at(self, half: float) -> int:
        """Return 0 for the upper and 1 for the lower wing at these half pitches from the top."""
        return int(min(half, 2 * self.around - half) > 0.5 * sum(self.seams))

    def row_at(self, half: float) -> float:
        """Return the stretched length (m) of a row ahead of the mouth at these half pitches."""
        return self.row * self.scales[self.wing_at(half)]

    @property
    def foremost(self) -> int:
        """Number of rows ahead of the mouth."""
        return max(self.rows)

    def reach(self, panel: str, k: float) -> float:
        """Return the width of a panel's wing from its seam on row ``k`` < 0, in half pitches."""
        pieces = self.plan.wing(panel) or self._side(panel)
        ahead = (-k) * self.row * self.scales[panel in ('lower', 'side_lower')]
        whole = 2 * self.around / self.plan.circumference
        for number, piece in enumerate(pieces):
            front, back = piece.widths
            last = number == len(pieces) - 1
            if ahead <= piece.length or last:
                share = min(ahead / piece.length, 1.0)
                width = back + share * (front - back)
                # Where one piece is the whole panel, half of it lies on either side.
                return whole * (0.5 * width if self._is_whole(panel, number) else width)
            ahead -= piece.length
        return 0.0

    def _side(self, panel: str) -> list[PieceRecord]:
        return self.plan.wing('side') if panel.startswith('side') else []

    def _is_whole(self, panel: str, number: int) -> bool:
        if panel.startswith('side'):
            return not self.plan.wing(panel)
        return self.plan.wing(panel)[number].pieces == 1

    @cached_property
    def edges(self) -> dict[int, tuple[int, int, int, int]]:
        """First and last node of the upper and of the lower wing, for each row ahead of the mouth.

        They are half pitches, from the top down. A wing that does not reach the row has its first
        node behind its last. Adjoining wings leave no gap.
        """
        found: dict[int, tuple[int, int, int, int]] = {}
        upper, lower = self.seams
        closed = self._closed('upper'), self._closed('lower')
        for k in range(-1, -self.foremost - 1, -1):
            top, first, second, bottom = 1, 0, 1, 0
            if -k <= self.rows[0]:
                top = self._inner('upper', k, closed[0])
                first = max(_near(upper + self.reach('side_upper', k), k), top)
            if -k <= self.rows[1]:
                bottom = self.around - self._inner('lower', k, closed[1])
                second = min(_near(lower - self.reach('side_lower', k), k), bottom)
            if -k <= min(self.rows) and second - first <= 2:
                # Both wings meet on the side.
                second = first + 2
            found[k] = top, first, second, bottom
        return found

    def _gap_half(self, panel: str, k: int) -> float:
        """Return the half pitches from the middle of a panel to its wing on row ``k``."""
        upper, lower = self.seams
        half = upper if panel == 'upper' else self.around - lower
        return half - self.reach(panel, k)

    def _closed(self, panel: str) -> int:
        """Return the foremost row from which on aft a panel is whole.

        It is even, so that a node lies in the middle of the panel.
        """
        k = 0
        while -k < self.foremost and self._gap_half(panel, k - 1) <= 1.0:
            k -= 1
        return k + k % 2

    def _inner(self, panel: str, k: int, closed: int) -> int:
        """Return the half pitches from the middle of a panel to the first node of its wing."""
        if k >= closed:
            return k % 2
        return max(_near(self._gap_half(panel, k), k), 2 + k % 2)

    @property
    def corner(self) -> int:
        """Half pitches from the middle of the upper panel to the corner of wing and bosom.

        They are those of the lower panel if the upper one has no bosom.
        """
        top, _, _, bottom = self.edges[-1]
        return (top - 1) or (self.around - bottom - 1)

    def holds(self, k: int, half: int) -> bool:
        """Return True for a node that belongs to the net."""
        if k >= 0:
            return True
        if k not in self.edges:
            return False
        half = min(half, 2 * self.around - half)
        top, first, second, bottom = self.edges[k]
        return top <= half <= first or second <= half <= bottom

    @property
    def tips(self) -> tuple[Place, Place]:
        """Nodes of the port wing tips to which bridles are shackled.

        They lie on the seams if the side is cut out, else at the ends of headrope and footrope.
        """
        places = []
        for which in (0, 1):
            k = -self.rows[which]
            low, high = self.edges[k][2 * which : 2 * which + 2]
            if self.open_side:
                half = low + 2 * round((self.seams[which] - low) / 2)
                places.append((k, int(np.clip(half, low, high))))
            else:
                places.append((k, (low, high)[which]))
        return places[0], places[1]

    @property
    def open_side(self) -> bool:
        """True if the side is cut out between upper and lower wing."""
        shorter = self.edges[-min(self.rows)]
        return shorter[2] - shorter[1] > 2

    def headrope(self) -> FrameRope:
        """Return the headrope from the port wing tip to the starboard one."""
        return self._across(0)

    def footrope(self) -> FrameRope:
        """Return the footrope from the port wing tip to the starboard one."""
        return self._across(1)

    def _across(self, which: int) -> FrameRope:
        k, tip = self.tips[which]
        # Half pitches from the middle of the gap, which shrinks toward the mouth.
        turned = [self.around - half if which else half for half in (tip, *self._gap(which))]
        port = [(k, h) for h in range(turned[0], turned[1] - 1, -2)]
        port += _down(k, turned[1:])
        middle = self.around if which else 0
        half = [(row, middle - h if which else h) for row, h in port]
        other = [(row, (2 * self.around - h) % (2 * self.around)) for row, h in half[-2::-1]]
        places = [*half, *other]
        ahead = len(range(turned[0], turned[1] - 1, -2)) - 1
        return self._rope(places, tips=ahead)

    def _gap(self, which: int) -> list[int]:
        """Return the half pitches of a wing's inner edge, row by row from its tip to the mouth."""
        rows = range(-self.rows[which], 0)
        middle = self.around if which else 0
        edge = [self.edges[k][3 * which] for k in rows]
        closed = next((n for n, half in enumerate(edge) if half == middle), len(edge))
        return [*edge[:closed], middle]

    def side_rope(self) -> FrameRope:
        """Return the rope from the upper to the lower wing tip at port.

        It is the line of the wing end if the side is not cut out.
        """
        (k_up, up), (k_low, low) = self.tips
        if not self.open_side:
            if k_up != k_low:
                raise GearError(
                    'netting.plan: found wings of different length on a side that is not cut out, '
                    'expected side_upper and side_lower wings, or upper and lower wings of one '
                    'length'
                )
            places = [(k_up, half) for half in range(up, low + 1, 2)]
            return self._rope(places, tips=len(places))
        upper = [(k_up, h) for h in range(up, self.edges[k_up][1] + 1, 2)]
        lower = [(k_low, h) for h in range(low, self.edges[k_low][2] - 1, -2)]
        above = [self.edges[k][1] for k in range(k_up, 0)]
        below = [self.edges[k][2] for k in range(k_low, 0)]
        together = [
            k for k in range(-min(self.rows), 0) if self.edges[k][2] - self.edges[k][1] <= 2
        ]
        last = together[0] if together else 0
        tips = len(upper) - 1, len(lower) - 1
        upper += [(k, -h) for k, h in _down(k_up, [-h for h in above[: last - k_up]])]
        lower += _down(k_low, below[: last - k_low])
        first = upper[-1][1] + ((upper[-1][1] - last) % 2 or 2 * (upper[-1][0] == last))
        end = lower[-1][1] if lower[-1][0] == last else lower[-1][1] + 1
        bosom = [(last, h) for h in range(first, end, 2)]
        places = [*upper, *bosom, *lower[::-1]]
        rope = self._rope(places, tips=0)
        kinds = list(rope.kinds)
        kinds[: tips[0]] = ['tip'] * tips[0]
        if tips[1]:
            kinds[-tips[1] :] = ['tip'] * tips[1]
        return FrameRope(rope.places, rope.netting, tuple(kinds))

    def _rope(self, places: list[Place], tips: int) -> FrameRope:
        """Return the rope over places; its first and last ``tips`` stretches are the wing tips."""
        netting, kinds = [], []
        for number, ((k, h), (row, half)) in enumerate(pairwise(places)):
            rows, across = abs(row - k), min(abs(half - h), 2 * self.around - abs(half - h))
            along = rows * self.row_at(0.5 * (h + half))
            netting.append(along if across <= rows else max(along, self.row * across))
            at_tip = min(number, len(places) - 2 - number) < tips
            kinds.append('tip' if at_tip else 'edge' if rows else 'bosom')
        return FrameRope(tuple(places), tuple(netting), tuple(kinds))


def _near(half: float, row: int) -> int:
    """Return the nearest half pitch at which a row has a node."""
    odd = row % 2
    return 2 * round((half - odd) / 2) + odd


def _down(k: int, edge: list[int]) -> list[Place]:
    """Return the places along an edge behind its first row ``k``, toward the mouth.

    Half pitches fall toward the mouth. The rope runs over the nodes without netting ahead of them,
    and passes over notches.
    """
    places: list[Place] = []
    for n in range(1, len(edge)):
        before, here = edge[n - 1], edge[n]
        if here < before:
            places += [(k + n, h) for h in range(before - 1, here - 1, -2)]
        elif not (n + 1 < len(edge) and edge[n + 1] < here):
            places.append((k + n, here))
    return places
