"""Stretch of a tow that the model is towed along, through falls of boards at sea or in the model.

Where boards fall, derivatives do not hold: they stay as they were before, the model is towed on,
and stretches count again once all has settled behind. Where boards lie for long, fall again before
that, are tossed about, or no step leads on, the motion ends.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.under_way import AFTER_A_FALL, MotionUnderWay
from trawl_ros.solver.motion.readings import MotionPrediction
from trawl_ros.solver.stepper import StepFailed

AGAIN_S = 120.0
"""Time after which a motion that has ended is begun anew."""

UNSTABLE = 1e6
"""Derivative of a mean by a coefficient, in its noise, from which a motion is unstable: behind a
tumble of boards derivatives may grow until normal equations are no longer definite."""

TOSSED = 8
"""Steps for each step of a tow, throughout a stretch, from which its boards are tossed about: where
they come to rest behind a jerk of the winches, four were enough."""

LONGEST_FALL_S = 60.0
"""Longest fall that the model is towed through: what its boards meet there no law of theirs has."""

BY_SENSOR = 'a board has fallen, by its sensor'

Means = TypeVar('Means')


@dataclass(frozen=True)
class NotTowed:
    """Reason why a stretch has no means; ``ends`` where the motion ends with it."""

    why: str
    ends: bool = False


def tow_along(
    motion: MotionUnderWay,
    tow: MovingTow,
    stretch: int,
    averaged: Callable[[list[MotionPrediction]], Means | NotTowed],
) -> Means | NotTowed:
    """Tow along a stretch to its end.

    Parameters
    ----------
    motion
        Motion at the beginning of the stretch.
    tow, stretch
        Tow whose inputs it follows, and the number of the stretch.
    averaged
        Means of the stretch from its instants, or why derivatives do not hold.
    """
    fell = stretch in tow.fallen
    if fell:
        motion.hold(motion.towed.derivatives, stretch * tow.stretch_s)
    elif motion.held_since is not None and not motion.fallen:
        motion.release()
    try:
        found = _along(motion, tow, stretch, averaged)
    except StepFailed as error:
        return NotTowed(f'the model cannot be towed: {error}', ends=True)
    lasts = motion.held_since is not None and motion.time - motion.held_since > LONGEST_FALL_S
    if not isinstance(found, NotTowed):
        return found
    return NotTowed(BY_SENSOR if fell else found.why, found.ends or lasts)


def _along(
    motion: MotionUnderWay,
    tow: MovingTow,
    stretch: int,
    averaged: Callable[[list[MotionPrediction]], Means | NotTowed],
) -> Means | NotTowed:
    """Tow along, behind a step that fails with the derivatives held."""
    begin, held = stretch * tow.stretch_s, motion.held_since is not None
    end = begin + tow.stretch_s
    derivatives, steps = motion.towed.derivatives, motion.towed.steps
    instants, why = [motion.seen], AFTER_A_FALL if held else ''
    try:
        instants += motion.towed_on(end, tow.step_s)
    except StepFailed as error:
        if held:
            raise
        why = f'the model cannot be towed: {error}'
    tossed = motion.towed.steps - steps >= TOSSED * tow.steps
    if motion.fallen:
        why = 'a board of the model falls over'
    elif tossed:
        why = 'boards of the model are tossed about'
    if not why:
        if motion.surfaced:
            return NotTowed('the gear of the model breaks the surface')
        if begin < motion.counts_from:
            return NotTowed(motion.settles)
        means = averaged(instants)
        if not isinstance(means, NotTowed):
            return means
        why = means.why
    # Boards that fall again before all has settled go on falling.
    ends = not held and (tossed or begin < motion.counts_from)
    if not held and not ends:
        motion.hold(derivatives, begin)
        deque(motion.towed_on(end, tow.step_s), maxlen=0)
    return NotTowed(why, ends)


def refused_if_unstable(by_coefficients: FloatArray, noise: FloatArray) -> NotTowed | None:
    """Refuse derivatives (k, 12) of means whose noise is (k,), NaN where no reading came."""
    if np.any(np.abs(by_coefficients) > UNSTABLE * noise[:, None]):
        return NotTowed('the motion of the model is unstable')
    return None
