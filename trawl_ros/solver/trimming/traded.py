# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trim that may also change bridles, weights, floats or boards, if points are not enough."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np
from scipy.optimize import least_squares

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import GearModel
from trawl_ros.model.observables import observe
from trawl_ros.solver.advising.rig_changes import RigChange
from trawl_ros.solver.trimming.held_gear import HeldGear, attitude_at, coarsest_model
from trawl_ros.solver.trimming.measured import ANGLE_STEP, MeasuredAngles, inclination_range
from trawl_ros.solver.trimming.over_range import RangeTrim, trim_over_range

MISS_PER_LARGEST_CHANGE = 0.002
"""Relative miss of a wanted value that weighs as much as the largest change, which avoids useless
changes."""

RELATIVE_AMOUNT_STEP = 0.02
"""Step of differences by an amount, relative to the largest."""

MIN_RELATIVE_AMOUNT = 0.005
"""Amount, relative to the largest, below which a change is left out."""

TRIED_FRACTIONS = 0.5, 1.0
"""Fractions of the largest amount that are tried where operating points are not usable."""

EVALUATIONS = 25

AMOUNT_FACTORS = MappingProxyType({'bridles': 4.0})
"""Factors on the largest amounts of advice, by kind: a wanted value may need more."""


@dataclass(frozen=True)
class Traded:
    """Changes of a rigging by amounts."""

    changes: tuple[tuple[RigChange, float], ...] = ()

    def model(self, model: GearModel) -> GearModel:
        """Return the model of the changed gear."""
        for change, amount in self.changes:
            model, _ = change.applied(model, 100.0, amount)
        return model

    def gear(self, gear: GearRecord) -> GearRecord:
        """Return the record of the changed gear, for its file."""
        for change, amount in self.changes:
            gear = change.recorded(gear, amount)
        return gear

    @property
    def told(self) -> str:
        """The changes in words; '' for none."""
        return ', '.join(change.told(amount) for change, amount in self.changes)


def trade_for_place(
    model: GearModel,
    changes: Sequence[RigChange],
    near: MeasuredAngles,
    *,
    warp_length: float,
    speed: float,
    pitch: float = 0.0,
) -> tuple[MeasuredAngles, Traded]:
    """Find angles of the boards and changes of the rigging for a wanted spread and depth.

    Parameters
    ----------
    model
        The gear.
    changes
        Changes that are allowed.
    near
        Nearest angles without changes, and the wanted values.
    warp_length, speed, pitch
        As `angles_from` has them.

    Returns
    -------
    angles, traded
        Angles that reach the wanted values or come nearest, and the changes for them.
    """
    coarse, place = coarsest_model(model), (warp_length, speed)
    low, high = coarse.board.law.range
    margin = 0.02 * (high - low)
    inclinations = inclination_range(pitch)
    room = np.ones(len(changes))
    bounds = (
        np.concatenate([[low + margin, inclinations[0]], 0.0 * room]),
        np.concatenate([[high - margin, inclinations[1]], 2.0 * room]),
    )

    def rotations(angles: FloatArray) -> FloatArray:
        return attitude_at(coarse, place, float(angles[0]), float(angles[1]), pitch)

    first = np.clip([near.attack, near.inclination], bounds[0][:2], bounds[1][:2])
    held = HeldGear(coarse, rotations(first), [place])
    best, least = (near, Traded()), np.inf

    def missed(x: FloatArray) -> FloatArray:
        nonlocal best, least
        # SciPy takes steps relative to x, which must not be 0: amounts are counted from 1.
        amounts = x[2:] - 1.0
        traded = _traded(changes, amounts)
        try:
            held.regeared(traded.model(coarse))
            held.turned(rotations(x[:2]), coarse.board.points)
        except NoSteadyState:
            return np.ones(len(x))
        (acting, tow), state = held.acting[0], held.states[0]
        seen = observe(acting, state, tow)
        wish = np.array([seen.door_spread / near.spread, seen.door_depth / near.depth]) - 1.0
        left = np.concatenate([wish, MISS_PER_LARGEST_CHANGE * amounts])
        if (miss := float(left @ left)) < least:
            least = miss
            angles = MeasuredAngles(float(x[0]), float(x[1]), near.spread, near.depth, seen)
            best = angles, traded
        return left

    least_squares(
        missed,
        np.concatenate([first, room]),
        bounds=bounds,
        diff_step=[ANGLE_STEP, ANGLE_STEP, *(RELATIVE_AMOUNT_STEP * room)],
        x_scale=[0.1, 0.2, *room],
        xtol=1e-4,
        ftol=1e-6,
        max_nfev=EVALUATIONS,
    )
    return best


def trade_for_range(
    model: GearModel,
    changes: Sequence[RigChange],
    found: RangeTrim,
    *,
    attack: float,
    inclination: float,
    pitch: float = 0.0,
    on_progress: OnProgress = ignore,
) -> tuple[RangeTrim, Traded]:
    """Find a change of the rigging with which the whole range can be towed.

    Parameters
    ----------
    model
        The gear.
    changes
        Changes, of which one may be made.
    found
        The trim without changes.
    attack, inclination, pitch
        As `trim_over_range` has them.
    on_progress
        Called with each change that is tried.

    Returns
    -------
    trimmed, traded
        The trim with most usable states, and its change.
    """
    again = partial(
        trim_over_range,
        attack=attack,
        inclination=inclination,
        pitch=pitch,
        warp_lengths=sorted({point.warp_length for point in found.found}),
        speeds=sorted({point.speed for point in found.found}),
    )
    best, traded = found, Traded()
    coarse = coarsest_model(model)
    trials = [
        (change, sign * share)
        for share in TRIED_FRACTIONS
        for change in changes
        for sign in (1, -1)
    ]
    for done, (change, share) in enumerate(trials):
        on_progress(WorkProgress('traded riggings', done, len(trials), change.kind))
        tried = Traded(((change, share * _most(change)),))
        try:
            quick = again(tried.model(coarse))
            if quick.usable <= best.usable:
                continue
            whole = again(tried.model(model))
        except NoSteadyState:
            continue
        if whole.usable > best.usable:
            best, traded = whole, tried
        if best.usable == len(best.found):
            break
    return best, traded


def _most(change: RigChange) -> float:
    """Return the largest amount of a change."""
    return AMOUNT_FACTORS.get(change.kind, 1.0) * change.most


def _traded(changes: Sequence[RigChange], amounts: FloatArray) -> Traded:
    return Traded(
        tuple(
            (change, float(amount) * _most(change))
            for change, amount in zip(changes, amounts, strict=True)
            if abs(amount) > MIN_RELATIVE_AMOUNT
        )
    )
