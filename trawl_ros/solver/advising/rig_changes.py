# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Changes of a rigging: fastening points, weights, floats, bridles, warp, and lighter boards."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.errors import GearError
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel, build_model

POINTS = "the warp's point", "the upper bridle's point", "the lower bridle's point"
"""Fastening points of a board in the order of the gear file."""

KINDS = 'bridles', 'weights', 'floats', 'clump', 'boards'
"""Kinds of changes that a user may allow: weights and floats on ropes, clump at the tips."""

MOVES = {0: ('forward', 'aft'), 2: ('up', 'down')}
"""Directions of a point's coordinates by sign; the distance from the face is fixed by the board."""


@dataclass(frozen=True)
class RigChange:
    """Change of a rigging by an amount of either sign.

    Attributes
    ----------
    kind
        One of `KINDS`, ``points`` or ``warp``.
    step
        Small amount, for derivatives.
    most
        Largest amount that is considered.
    gear, model, warp
        Functions that return gear record, model or warp length after a change; one is given.
    told
        Function that describes an amount in words.
    """

    kind: str
    step: float
    most: float
    told: Callable[[float], str]
    gear: Callable[[GearRecord, float], GearRecord] | None = None
    model: Callable[[GearModel, float], GearModel] | None = None
    warp: Callable[[float, float], float] | None = None

    def applied(
        self, model: GearModel, warp_length: float, amount: float
    ) -> tuple[GearModel, float]:
        """Return gear and warp length (m) after a change; the net keeps its nodes and bars."""
        if self.model is not None:
            return self.model(model, amount), warp_length
        if self.warp is not None:
            return model, self.warp(warp_length, amount)
        assert self.gear is not None
        return rebuilt(model, self.gear(model.gear, amount)), warp_length

    def recorded(self, gear: GearRecord, amount: float) -> GearRecord:
        """Return the gear record after a change of weights, floats, bridles or the boards' mass."""
        if self.kind == 'boards':
            board = gear.board.model_copy(update={'mass_kg': gear.board.mass_kg + amount})
            return gear.model_copy(update={'board': board})
        assert self.gear is not None
        return self.gear(gear, amount)


def rebuilt(model: GearModel, gear: GearRecord) -> GearModel:
    """Build the model of a changed gear with the same nodes, bars, board and coefficients."""
    return replace(
        build_model(gear),
        board=model.board,
        coefficients=model.coefficients,
        pattern=model.pattern,
    )


def rig_changes(gear: GearRecord) -> tuple[RigChange, ...]:
    """Return all changes that a gear's rigging allows."""
    boards = () if gear.pair is not None else (board_change(gear),)
    return (
        *hung_changes(gear),
        *bridle_changes(gear),
        *point_changes(gear),
        *boards,
        WARP,
    )


def changes_of(gear: GearRecord, kinds: Sequence[str]) -> tuple[RigChange, ...]:
    """Return the changes of these `KINDS`.

    Raises
    ------
    GearError
        If the gear has none of a kind.
    """
    every = rig_changes(gear)
    there = [kind for kind in KINDS if any(change.kind == kind for change in every)]
    for kind in kinds:
        if kind not in there:
            raise GearError(
                f"'{gear.name}' has no {kind} to change, expected one of {', '.join(there)}"
            )
    return tuple(change for change in every if change.kind in kinds)


def hung_changes(gear: GearRecord) -> tuple[RigChange, ...]:
    """Return relative changes of weights and floats on ropes and wing tips."""
    found = []
    for number, item in enumerate(gear.hung):
        if item.force_on(1.0) == 0.0:  # a kite alone
            continue
        kind = 'weight' if item.sinks else 'buoyancy'
        found.append(
            _share('weights' if item.sinks else 'floats', f"{kind} of '{item.name}'", _hung(number))
        )
    if gear.clump.weight_in_water_n > 0.0:
        found.append(_share('clump', 'weight of the clump', _at_tips('clump', 'weight_in_water_n')))
    if gear.floats.buoyancy_n > 0.0:
        found.append(_share('floats', 'buoyancy of the floats', _at_tips('floats', 'buoyancy_n')))
    return tuple(found)


def bridle_changes(gear: GearRecord) -> tuple[RigChange, ...]:
    """Return changes of the bridles' lengths, in m, equal on both sides."""
    found = []
    for own in gear.bridles:
        length = gear.bridle_of(own).length_m

        def told(amount: float, name: str = own.name) -> str:
            return f'{abs(amount):.2g} m {"longer" if amount > 0 else "shorter"} {name} bridles'

        def change(gear: GearRecord, amount: float, name: str = own.name) -> GearRecord:
            bridles = tuple(
                one
                if one.name != name
                else one.model_copy(update={'length_m': gear.bridle_of(one).length_m + amount})
                for one in gear.bridles
            )
            return gear.model_copy(update={'bridles': bridles})

        found.append(RigChange('bridles', 0.002 * length, 0.05 * length, told, change))
    return tuple(found)


def point_changes(gear: GearRecord) -> tuple[RigChange, ...]:
    """Return moves of the fastening points along the chord and the span, in m."""
    if gear.pair is not None:
        return ()
    found = []
    for number, point in enumerate(POINTS):
        for axis, (more, less) in MOVES.items():

            def told(amount: float, point: str = point, way: tuple[str, str] = (more, less)) -> str:
                where = way[0 if amount > 0 else 1]
                return f'{point} {100 * abs(amount):.2g} cm further {where}'

            def change(
                model: GearModel, amount: float, number: int = number, axis: int = axis
            ) -> GearModel:
                points = model.board.points.copy()
                points[number, axis] += amount
                return model.with_board(points=points)

            room = 0.1 * gear.board.chord_m
            found.append(RigChange('points', 0.005, room, told, model=change))
    return tuple(found)


def board_change(gear: GearRecord) -> RigChange:
    """Return the change of the boards' mass, in kg; their size and inertia stay."""

    def told(amount: float) -> str:
        newtons = abs(amount) * gear.water.gravity_m_s2
        return f'{1e-3 * newtons:.2g} kN {"more" if amount > 0 else "less"} weight of each board'

    def change(model: GearModel, amount: float) -> GearModel:
        return model.with_board(mass=model.board.mass + amount)

    mass = gear.board.mass_kg
    return RigChange('boards', 0.005 * mass, 0.3 * mass, told, model=change)


def _share(kind: str, what: str, change: Callable[[GearRecord, float], GearRecord]) -> RigChange:
    def told(amount: float) -> str:
        return f'{100 * abs(amount):.0f} % {"more" if amount > 0 else "less"} {what}'

    return RigChange(kind, 0.02, 0.5, told, change)


def _hung(number: int) -> Callable[[GearRecord, float], GearRecord]:
    def change(gear: GearRecord, amount: float) -> GearRecord:
        item = gear.hung[number]
        keys = 'weight_in_water_n', 'buoyancy_n', 'weight_in_water_n_m', 'buoyancy_n_m'
        new = item.model_copy(update={key: (1.0 + amount) * getattr(item, key) for key in keys})
        return gear.model_copy(
            update={'hung': (*gear.hung[:number], new, *gear.hung[number + 1 :])}
        )

    return change


def _at_tips(record: str, key: str) -> Callable[[GearRecord, float], GearRecord]:
    def change(gear: GearRecord, amount: float) -> GearRecord:
        own = getattr(gear, record)
        new = own.model_copy(update={key: (1.0 + amount) * getattr(own, key)})
        return gear.model_copy(update={record: new})

    return change


WARP = RigChange(
    'warp',
    0.01,
    0.3,
    lambda amount: f'{100 * abs(amount):.0f} % {"more" if amount > 0 else "less"} warp',
    warp=lambda length, amount: float(np.round(length * (1.0 + amount), 6)),
)
"""Change of the length of both warps."""
