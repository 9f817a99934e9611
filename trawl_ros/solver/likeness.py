"""Likeness of two gears, as far as forces and observables ask: what is the same is left out.

An effect of an instrument changes no gear at all, one on a rope no board.
"""

from dataclasses import fields, is_dataclass

import numpy as np

from trawl_ros.model.gear_model import GearModel

NO_FORCE = frozenset({'gear', 'first_guess'})
"""Attributes of a gear model of which no force is made, but for the segments of a warp."""


def same_forces(one: GearModel, other: GearModel) -> bool:
    """True if two gears have the same forces in any state."""
    return one is other or (
        one.warp_segments == other.warp_segments
        and all(
            _same(getattr(one, field.name), getattr(other, field.name))
            for field in fields(GearModel)
            if field.name not in NO_FORCE
        )
    )


def same_observables(one: GearModel, other: GearModel) -> bool:
    """True if two gears have the same observables in any state."""
    return (
        _same(one.water, other.water)
        and _same(one.board.middles, other.board.middles)
        and _same(one.layout.headrope, other.layout.headrope)
        and _same(one.layout.footrope, other.layout.footrope)
        and _same(_top_of_warps(one), _top_of_warps(other))
    )


def _top_of_warps(model: GearModel) -> tuple[object, ...]:
    """Properties of which tensions at the blocks and angles of the warps are made."""
    top = model.layout.top_warp_bars
    arrays = model.warp_side, model.ends, model.rest, *model.bars.columns
    return model.warp_segments, *(array[top] for array in arrays)


def _same(one: object, other: object) -> bool:
    """True if two values are surely the same, in all their attributes."""
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, np.asarray(other))
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    if is_dataclass(one):
        return all(
            _same(getattr(one, field.name), getattr(other, field.name)) for field in fields(one)
        )
    return bool(one == other)
