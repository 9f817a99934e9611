# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Refit of the boards of a gear to which an earlier diagnosis has added effects."""

from dataclasses import replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, Slice
from trawl_ros.diagnosis.inference.candidates import Candidate, extended, lower_edges, signatures
from trawl_ros.diagnosis.inference.refit import OPTIONS, Refit, converged, fit_boards, likelier
from trawl_ros.effects.effect_set import ActiveEffect
from trawl_ros.estimation.fit.estimator import POOR_MISFIT, Estimator
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor


def fit_beside(
    predictor: Predictor, prior: ParameterVector, windows: tuple[SteadyWindow, ...]
) -> Refit | None:
    """Fit the boards with the added effects held; None where no window has a steady state.

    From where the gear file has them. With warp lengths and speed as they are shown a strong effect
    may leave hardly a steady state, and a fit that begins there stops at once. Then boards are
    fitted without the effects first, and these come in as they did when they were found: together
    with what they change, and with errors of counters and log.

    Parameters
    ----------
    predictor
        The gear; its effects ``new`` are those that were added.
    prior
        Of its boards.
    windows
        To be explained.
    """
    with_effects = fit_boards(predictor, prior, windows, start=predictor.model.coefficients)
    steady = [effect for effect in predictor.fixed.effects if not effect.effect.dynamic]
    added = [effect for effect in steady if effect.name in predictor.new]
    if not added or (with_effects is not None and with_effects.fit.birge_ratio < POOR_MISFIT):
        return with_effects
    without = replace(predictor, fixed=predictor.fixed.without(predictor.new))
    base = fit_boards(without, prior, windows)
    if base is None:
        return with_effects
    wanted = tuple(_nearest(effect, base) for effect in added)
    values = np.concatenate([effect.values for effect in added])
    columns = signatures(without, base.fit.windows, wanted)
    windows_extended = extended(base.fit, wanted, columns, OPTIONS).windows
    free = converged(without, base, wanted, values, windows_extended)
    if free is None:
        return with_effects
    estimator = Estimator(predictor, prior, OBSERVABLES, OPTIONS)
    board = prior.slice_of('coefficients')
    held = [_held(linear, board, values) for linear in free.fit.windows]
    estimator.begin(held, free.estimate.values[board])
    estimate = estimator.finish()
    return likelier(with_effects, None if estimate is None else Refit((), estimator, estimate))


def _nearest(active: ActiveEffect, base: Refit) -> Candidate:
    """Candidate of an effect, at the start nearest to its found values."""
    depths = lower_edges(base.fit.windows)
    places = [
        Candidate(active.effect, start, place)
        for place, start in enumerate(active.effect.starts(depths))
    ]

    def away(candidate: Candidate) -> float:
        return float(np.linalg.norm((candidate.start - active.values) / candidate.scale))

    return min(places, key=away)


def _held(linear: Linearised, board: Slice, values: FloatArray) -> Linearised:
    """Window with the effects at these values, and only coefficients free."""
    predicted = linear.predicted(np.concatenate((linear.at[board], values)))
    return replace(linear.only(board), values=predicted)
