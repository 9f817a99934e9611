# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""A door of the catalogue on a gear: shackle points at which its boards have a usable state.

Fastening points belong to the loads of a door, so another door needs others. The search tries a few
attack angles in the range of the door's law, and a few inclinations. It takes the first state that
is stable, under water and within the law.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.gear.boards import BoardRecord
from trawl_ros.gear.edit import WRITTEN_DECIMALS
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.equilibrium import SteadyState, steady_state
from trawl_ros.solver.trim import Trim, trim


@dataclass(frozen=True)
class DoorOptions:
    """Options of the search.

    Attributes
    ----------
    range_fractions
        Attack angles tried, as fractions of the range of the door's law, in this order.
    inclinations_deg
        Inclinations tried at each of them, degrees.
    lift_factors
        Lifts of a plate of another size that are tried for a refused door, over the old lift.
    """

    range_fractions: tuple[float, ...] = (0.3, 0.6)
    inclinations_deg: tuple[float, ...] = (12.0, 20.0, 6.0)
    lift_factors: tuple[float, ...] = (1.0, 0.8)


OPTIONS = DoorOptions()


@dataclass(frozen=True)
class FittedDoor:
    """Gear with a door, and the trim with its shackle points and usable steady state.

    ``before`` is the steady state with the old boards, or None if it was not usable.
    """

    gear: GearRecord
    trim: Trim
    before: SteadyState | None


def gear_with_door(gear: GearRecord, door: str, area_m2: float | None = None) -> GearRecord:
    """Return the gear with the law of a door, without corrections, at the old fastening points.

    Parameters
    ----------
    gear
        Gear with boards.
    door
        Name in the catalogue, or a file like those.
    area_m2
        Area of the new plate; span, chord and fastening points grow with its root. By default the
        plate stays. Mass and volume always stay.
    """
    board = gear.board
    data = board.model_dump(exclude={'law', 'coefficients'})
    data['law'] = {'kind': 'table', 'door': door}
    if area_m2 is not None:
        size = float(np.sqrt(area_m2 / board.area_m2))
        del data['inertia']
        data |= {
            'area_m2': area_m2, 'span_m': size * board.span_m, 'chord_m': size * board.chord_m,
            'fastening': {
                name: tuple(size * x for x in point) for name, point in board.fastening
            },
        }  # fmt: skip
    return gear.model_copy(update={'board': BoardRecord.model_validate(data)})


def fit_door(
    gear: GearRecord,
    door: str,
    *,
    warp_length: float,
    speed: float,
    area_m2: float | None = None,
    on_progress: OnProgress = ignore,
) -> FittedDoor:
    """Put a door of the catalogue or of a file on a gear, with shackle points that suit it.

    Parameters
    ----------
    gear
        Gear with boards; the search starts from its fastening points.
    door
        Name in the catalogue, or a file like those.
    warp_length, speed
        Operating point at which the gear must be usable, m and m/s.
    area_m2
        Area of the new plate; by default the plate stays.
    on_progress
        Called before each attitude that is tried.

    Raises
    ------
    NoSteadyState
        If no attitude tried is usable. The message says what was found, and whether a plate with
        the lift of the old boards would do.
    GearError
        If there is no such door, or the gear has no boards.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.solver.trimming.new_door import fit_door
    >>> gear = trawl_ros.load_gear('kaifuha').refined(net=0.25)
    >>> found = fit_door(gear, 'low_aspect_cambered', warp_length=500.0, speed=2.1)
    >>> found.gear.board.law.door
    'low_aspect_cambered'
    """
    gear.require_boards('that could be replaced')
    try:
        before = steady_state(build_model(gear), warp_length, speed)
    except NoSteadyState:
        before = None
    new = gear_with_door(gear, door, area_m2)
    refusals: list[NoSteadyState] = []
    tried = _first_usable(new, warp_length, speed, refusals, on_progress)
    if tried is not None:
        return FittedDoor(new, tried, before)
    refused = (
        f'{door} on {gear.name}: {len(refusals)} attitudes were tried and none is usable; the '
        f'first: {refusals[0]}'
    )
    equal = _equal_lift_area(gear, new, before)
    told = (
        f'{refused}. At {new.board.area_m2:.3g} m² it has {new.board.area_m2 / equal:.2f} times '
        f'the lift of the old boards'
    )
    for factor in OPTIONS.lift_factors:
        area = round(factor * equal, 1)
        other = gear_with_door(gear, door, area)
        if _first_usable(other, warp_length, speed, [], on_progress) is not None:
            raise NoSteadyState(f'{told}; a plate of {area:g} m² is usable', refusals[0].reason)
    raise NoSteadyState(
        f'{told}; plates of {" and ".join(f"{f * equal:.1f}" for f in OPTIONS.lift_factors)} m² '
        'are not usable either: expected another warp, speed or rigging',
        refusals[0].reason,
    )


def _first_usable(
    gear: GearRecord,
    warp_length: float,
    speed: float,
    refusals: list[NoSteadyState],
    on_progress: OnProgress,
) -> Trim | None:
    model, attitudes = build_model(gear), list(_attitudes(gear))
    for done, (attack, inclination) in enumerate(attitudes):
        on_progress(WorkProgress('attitudes', done, len(attitudes)))
        try:
            found = trim(
                model,
                attack=attack,
                inclination=inclination,
                warp_length=warp_length,
                speed=speed,
            )
            # A file has millimetres, which already change the attack a little.
            points = np.round(found.points, WRITTEN_DECIMALS)
            written, near = model.with_board(points=points), found.steady.equilibrium.state
            return Trim(points, written, steady_state(written, warp_length, speed, near=near))
        except NoSteadyState as refusal:
            refusals.append(refusal)
    return None


def _attitudes(gear: GearRecord) -> Iterator[tuple[float, float]]:
    low, high = build_model(gear).board.law.range
    for lean, fraction in product(OPTIONS.inclinations_deg, OPTIONS.range_fractions):
        yield low + fraction * (high - low), float(np.radians(lean))


def _equal_lift_area(old: GearRecord, new: GearRecord, state: SteadyState | None) -> float:
    """Return the area (m²) at which the new boards have the lift of the old ones.

    The old ones work as in their state, the new ones at the first attack tried. Without a state,
    both work at this fraction of the ranges of their laws.
    """
    lifts = []
    for gear, known in ((old, state), (new, None)):
        board = build_model(gear).board
        low, high = board.law.range
        attack = low + OPTIONS.range_fractions[0] * (high - low)
        if known is not None:
            attack = known.observables.port_attack
        lifts.append(float(board.law(gear.board.coefficients.array(), attack, 0.0)[1]))
    return old.board.area_m2 * lifts[0] / lifts[1]
