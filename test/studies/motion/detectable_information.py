"""Information of tows in motion on the values of effects, with all that errs eliminated.

Errors are those of the fit in motion, as `trawl identify` states them; beside them the model is
taken to be wrong by what changes with the length of the warps, as a diagnosis of windows takes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.diagnosis.inference.candidates import Candidate
from trawl_ros.diagnosis.inference.marginal import Marginal
from trawl_ros.diagnosis.onset.candidates import WATCHED
from trawl_ros.diagnosis.onset.gear import WatchedGear
from trawl_ros.effects.effect_set import ActiveEffect, EffectSet
from trawl_ros.estimation.fit.error_terms import GROUPS, LONGER, USUAL_LENGTH
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.expected import expected_rows
from trawl_ros.estimation.motion.fit_records import MotionOptions
from trawl_ros.estimation.motion.sizes import LinearData
from trawl_ros.estimation.motion.towing.inputs import without_errors
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.model.gear_model import GearModel

OPTIONS = MotionOptions()


@dataclass(frozen=True)
class ExaminedGear:
    """Gear in order with the effects of its file, its coefficients (12,) with their prior, and
    effects that it might have, each with the values about which it is looked for.
    """

    model: GearModel
    known: EffectSet
    coefficients: FloatArray
    prior: ParameterVector
    wanted: tuple[Candidate, ...]

    @property
    def watched(self) -> WatchedGear:
        """The gear; of the effects that it might have those act that are looked for elsewhere than
        at neutral values, as a ground without friction at a depth.
        """
        acting = self.known
        for one in self.wanted:
            if not np.array_equal(one.start, one.effect.neutral):
                acting = acting.having(ActiveEffect(one.effect, one.start))
        return WatchedGear(self.model, acting, tuple(one.effect for one in self.wanted))

    @property
    def units(self) -> FloatArray:
        """Units (m,) in which values are counted."""
        return np.concatenate([candidate.scale for candidate in self.wanted])


@dataclass(frozen=True)
class MotionInformation:
    """Information of tows in motion.

    Attributes
    ----------
    evidence
        On all values of effects, in their units; the score is nought, as of a gear in order.
    added_mass
        On the boards' added mass, in `ADDED_MASS_STD`, as if nothing were known of it before.
    counted_s
        Time of all stretches that count.
    """

    evidence: Marginal
    added_mass: Marginal
    counted_s: float


def information_in_motion(gear: ExaminedGear, tows: Sequence[MovingTow]) -> MotionInformation:
    """Tow the gear along tows once, with derivatives by all, and eliminate what errs.

    Parameters
    ----------
    gear
        The gear.
    tows
        As they are read: which means there are, and their noise; their values do not count.

    Raises
    ------
    TrawlError
        If it cannot be towed along any stretch.
    """
    towed = gear.watched.towed
    linear, usual = expected_rows(towed, tows, gear.prior, gear.coefficients, OPTIONS)
    counted = sum(
        own.tow.stretch_s * float(np.sum(np.isfinite(own.residual).any(axis=1))) for own in linear
    )
    if not counted:
        raise TrawlError('the model cannot be towed along any stretch of the tows')
    data = _with_values(gear, linear, usual)
    matrix, number = data.joined(OPTIONS.sizes).matrix, len(gear.units)
    errors, values = np.split(np.arange(data.shared), [data.shared - number])
    mass = np.array([len(gear.prior)])
    return MotionInformation(
        _evidence(matrix, values, errors),
        _evidence(matrix, mass, np.setdiff1d(errors, mass)),
        counted,
    )


def _with_values(
    gear: ExaminedGear, linear: Sequence[LinearisedTow], data: LinearData
) -> LinearData:
    """Rows with more columns behind those that all tows share: trends of the model's error, and
    values of effects, which are shared too.
    """
    found = []
    first, added = data.shared, len(GROUPS) + len(gear.units)
    for groups, tow in zip(data.tows, linear, strict=True):
        longer = np.log(_lengths(tow.tow) / USUAL_LENGTH) / np.log(LONGER)
        effects = _by_values(gear.watched, tow) * gear.units
        wider = []
        for group in groups:
            stretches, usual = group.rows.stretches, group.columns
            trends = longer[stretches, None] * usual[:, first - len(GROUPS) : first]
            values = effects[stretches, group.rows.channels]
            every = np.hstack((usual[:, :first], trends, values, usual[:, first:]))
            wider.append(replace(group, columns=every))
        found.append(tuple(wider))
    logs = tuple(slice(log.start + added, log.stop + added) for log in data.logs)
    return replace(data, tows=tuple(found), logs=logs, shared=first + added)


def _lengths(tow: MovingTow) -> FloatArray:
    """Mean warp length (n,) of stretches, m."""
    inputs = without_errors(tow.inputs)
    return np.array([np.mean(inputs(time).inputs[:2]) for time in tow.middles])


def _by_values(watched: WatchedGear, linear: LinearisedTow) -> FloatArray:
    """Derivatives (n, k, m) of means by the values of all effects, on the gear and on sensors."""
    tow, inputs = linear.tow, without_errors(linear.tow.inputs)
    places = [WATCHED.index(name) for name in tow.channels]
    number = sum(len(effect.parameters) for effect in watched.effects)
    found = np.zeros((len(tow), len(places), number))
    for stretch in np.flatnonzero(linear.towed):
        moved = np.zeros((len(WATCHED), linear.by['examined'].shape[-1]))
        shown = np.zeros(len(WATCHED))
        moved[places], shown[places] = linear.by['examined'][stretch], linear.values[stretch]
        at = inputs(float(tow.middles[stretch])).situation
        found[stretch] = watched.by_values(moved, shown, at)[places]
    return found


def _evidence(matrix: FloatArray, wanted: IntArray, rest: IntArray) -> Marginal:
    """Marginal on the wanted of all parameters, by information (s, s) on all; the rest have their
    prior, of std 1, and are eliminated.
    """
    across = matrix[np.ix_(rest, wanted)]
    known = matrix[np.ix_(rest, rest)] + np.eye(len(rest))
    left = matrix[np.ix_(wanted, wanted)] - across.T @ np.linalg.solve(known, across)
    return Marginal(left, np.zeros(len(wanted)))
