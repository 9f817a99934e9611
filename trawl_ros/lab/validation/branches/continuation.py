# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Branch continuation of steady states over a lattice, each reached from all its neighbours.

A state that was found is the start for every neighbour, and also for the place it came from, so
each pair of neighbours is solved in both directions. Some places are also solved cold. If there
were a second branch, the answers at one place would differ.
"""

import time
from collections import deque
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from trawl_ros.core.errors import NoSteadyState, Refusal
from trawl_ros.model.gear_model import GearModel
from trawl_ros.solver.equilibrium import Equilibrium, find_equilibrium, require_usable
from trawl_ros.solver.operating_point import OperatingPoint

SAME_ROOT_M = 1e-3
"""Largest distance (m) between two roots that count as one."""

Verdict = Literal['usable'] | Refusal
Spot = tuple[int, int]
"""Row and column in the lattice."""


@dataclass(frozen=True)
class Place:
    """Gear with its operating point."""

    model: GearModel
    point: OperatingPoint


@dataclass(frozen=True)
class Search:
    """Search for a root: its equilibrium, or the refusal, and the CPU time (s)."""

    found: Equilibrium | None
    refusal: NoSteadyState | None
    seconds: float


@dataclass(frozen=True)
class Answer:
    """Result of all searches at a place.

    ``root`` is the usable root, or else the first one found, and ``refusal`` the reason why it may
    not be used. ``usable_roots`` counts usable roots more than `SAME_ROOT_M` apart. ``apart`` is
    the largest distance (m) between two roots. ``agreed`` is true if all searches found a root, or
    none did.
    """

    verdict: Verdict
    refusal: NoSteadyState | None
    root: Equilibrium | None
    usable_roots: int
    apart: float
    agreed: bool
    searches: int
    seconds: float

    @property
    def usable(self) -> Equilibrium | None:
        """The root, if it may be used."""
        return self.root if self.verdict == 'usable' else None


def search(place: Place, start: Equilibrium | None) -> Search:
    """Search for a root once."""
    began = time.process_time()
    found, refusal = None, None
    try:
        found = find_equilibrium(place.model, place.point, start)
    except NoSteadyState as error:
        refusal = error
    return Search(found, refusal, time.process_time() - began)


def largest_distance(one: Equilibrium, other: Equilibrium) -> float:
    """Largest distance (m), along an axis, of a node or board in two roots."""
    return float(
        max(
            np.abs(one.state.nodes - other.state.nodes).max(),
            np.abs(one.state.board_positions - other.state.board_positions).max(),
        )
    )


def neighbours(spot: Spot, places: Mapping[Spot, Place]) -> Iterator[Spot]:
    """Spots one row or column away."""
    for row, column in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        other = spot[0] + row, spot[1] + column
        if other in places:
            yield other


def continue_branches(
    places: Mapping[Spot, Place], first: Spot, also_cold: Collection[Spot]
) -> dict[Spot, Answer]:
    """Continue from one place outward to every other.

    Parameters
    ----------
    places
        The lattice.
    first
        Cold start of the continuation.
    also_cold
        Spots that are solved cold in any case. Places no neighbour leads to are, too.
    """
    searches: dict[Spot, list[Search]] = {}
    pending: deque[tuple[Spot, Equilibrium | None]] = deque([(first, None)])
    # Behind the walk: by then only what it never reached has not been searched.
    left = deque(places)
    while pending or left:
        if pending:
            spot, start = pending.popleft()
        else:
            spot, start = left.popleft(), None
            if spot == first or (spot in searches and spot not in also_cold):
                continue
        tried = search(places[spot], start)
        known = any(earlier.found for earlier in searches.get(spot, ()))
        searches.setdefault(spot, []).append(tried)
        if tried.found is not None and not known:
            pending.extend((other, tried.found) for other in neighbours(spot, places))
    return {spot: judged(place, searches[spot]) for spot, place in places.items()}


def judged(place: Place, searches: list[Search]) -> Answer:
    """Summarise the searches at a place: its roots, and those that may be used."""
    roots: list[Equilibrium] = []
    apart = 0.0
    for found in (tried.found for tried in searches if tried.found is not None):
        distances = [largest_distance(found, root) for root in roots]
        apart = max([apart, *distances])
        if all(one > SAME_ROOT_M for one in distances):
            roots.append(found)
    seconds = max(tried.seconds for tried in searches)
    refusals: list[NoSteadyState | None] = []
    for root in roots:
        began = time.process_time()
        try:
            require_usable(place.model, root)
            refusals.append(None)
        except NoSteadyState as error:
            refusals.append(error)
        seconds = max(seconds, time.process_time() - began + searches[0].seconds)
    if not roots:
        refusals = [tried.refusal for tried in searches]
    chosen = refusals.index(None) if None in refusals else 0
    refusal = refusals[chosen]
    found_by = sum(tried.found is not None for tried in searches)
    return Answer(
        verdict='usable' if refusal is None else refusal.reason,
        refusal=refusal,
        root=roots[chosen] if roots else None,
        usable_roots=refusals.count(None),
        apart=apart,
        agreed=found_by in (0, len(searches)),
        searches=len(searches),
        seconds=seconds,
    )
