# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Equality of two gear models in the properties on which forces, observables or mass depend.

It saves work: an effect of an instrument changes no gear, and one on a rope changes no board.
"""

from collections.abc import Sequence
from dataclasses import fields, is_dataclass

import numpy as np

from trawl_ros.model.board import Board
from trawl_ros.model.gear_model import GearModel

FORCELESS_FIELDS = frozenset({'gear', 'first_guess'})
"""Fields of a gear model on which no force depends, apart from the segments of a warp."""


def same_forces(one: GearModel, other: GearModel) -> bool:
    """Return True if two gears have the same forces in every state."""
    return one is other or (
        one.warp_segments == other.warp_segments
        and all(
            _same(getattr(one, field.name), getattr(other, field.name))
            for field in fields(GearModel)
            if field.name not in FORCELESS_FIELDS
        )
    )


def same_observables(one: GearModel, other: GearModel) -> bool:
    """Return True if two gears have the same observables in every state."""
    return (
        _same(one.water, other.water)
        and _same_middles(one.board, other.board)
        and _same(one.layout.headrope, other.layout.headrope)
        and _same(one.layout.footrope, other.layout.footrope)
        and _same_top_of_warps(one, other)
    )


def same_mass(one: GearModel, other: GearModel) -> bool:
    """Return True if two gears share all arrays of their mass, so that it is equal."""
    whole = 'ends', 'rest', 'warp_side', 'lump_mass', 'lump_added', 'kite', 'layout', 'pattern'
    return (
        _shared(one, other, whole)
        and _shared(one.bars, other.bars, ('mass', 'volume', 'added_normal', 'added_tangential'))
        and _shared(one.board, other.board, ('mass', 'inertia', 'added_mass', 'points'))
        and _shared(one.board, other.board, ('installation', 'rerigged'))
        and one.water.density == other.water.density
        and one.water.density_gradient == other.water.density_gradient
    )


def _same_middles(one: Board, other: Board) -> bool:
    """Return True if two boards have the same middles; compute these only if needed."""
    made_of = 'points', 'installation', 'rerigged'
    return _shared(one, other, made_of) or _same(one.middles, other.middles)


def _same_top_of_warps(one: GearModel, other: GearModel) -> bool:
    """Return True if tensions at the blocks and angles of the warps are the same."""
    made_of = 'warp_segments', 'warp_side', 'ends', 'rest', 'bars', 'layout'
    return _shared(one, other, made_of) or _same(_top_of_warps(one), _top_of_warps(other))


def _top_of_warps(model: GearModel) -> tuple[object, ...]:
    top = model.layout.top_warp_bars
    arrays = model.warp_side, model.ends, model.rest, *model.bars.columns
    return model.warp_segments, *(array[top] for array in arrays)


def _shared(one: object, other: object, names: Sequence[str]) -> bool:
    """Return True if two records share the same objects in these fields."""
    return all(getattr(one, name) is getattr(other, name) for name in names)


def _same(one: object, other: object) -> bool:
    """Return True if two values are equal in all their attributes."""
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
