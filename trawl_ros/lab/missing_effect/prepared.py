# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""What methods share: the fit of the boards, the first-order screen, and the form of an answer."""

import time
from dataclasses import dataclass

import numpy as np

from trawl_ros.diagnosis.diagnosis import values_of
from trawl_ros.diagnosis.holdout import HoldoutComparison, Split, split
from trawl_ros.diagnosis.inference.candidates import lower_edges
from trawl_ros.diagnosis.inference.decision import NamedCause, Verdict
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior
from trawl_ros.diagnosis.inference.refit import Refit, fit_boards
from trawl_ros.diagnosis.inference.screen import Screen, screen
from trawl_ros.diagnosis.instruments import possible, standing
from trawl_ros.diagnosis.library.entries import library
from trawl_ros.effects.effect_set import effects_of
from trawl_ros.effects.registry import catalogue
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.lab.missing_effect.records import (
    NOTHING,
    SOMETHING_ELSE,
    AnswerRecord,
    CoefficientsRecord,
    HeldOutRecord,
    SizeRecord,
)
from trawl_ros.lab.missing_effect.trials_folder import TrialInput
from trawl_ros.model.gear_model import build_model
from trawl_ros.solver.predict import Predictor

LEAST_PROBABILITY = 1e-6
"""Probabilities below it are not written."""


@dataclass(frozen=True)
class Prepared:
    """Fit and screen of a trial, which all baselines share.

    Attributes
    ----------
    data
        Data of the trial.
    predictor
        Model of the gear as it is known aboard.
    halves
        Windows kept back in the comparison of errors, and the others.
    base
        Fit of the boards alone to all windows.
    screen
        All hypotheses of the library to first order.
    seconds
        Processor time of this, s.
    """

    data: TrialInput
    predictor: Predictor
    halves: Split
    base: Refit
    screen: Screen
    seconds: float


def prepare(data: TrialInput) -> Prepared | None:
    """Fit the boards alone and screen the library; None if no window has a steady state."""
    begun = time.process_time()
    windows, _ = standing(data.windows, data.tows)
    halves = split(windows, data.baseline)
    predictor = Predictor(build_model(data.gear), effects_of(data.gear), without=data.baseline)
    base = fit_boards(predictor, board_prior(data.gear), windows)
    if base is None:
        return None
    examined = [window for window in windows if window.tow not in data.baseline]
    entries = library(data.gear, possible(catalogue(), examined)[0])
    depths = lower_edges(base.fit.windows)
    seen = screen(predictor, base.fit, entries, depths, InferenceOptions().errors)
    seconds = time.process_time() - begun
    return Prepared(data, predictor, halves, base, seen, seconds)


def answer(
    posterior: Posterior,
    verdict: Verdict,
    named: tuple[NamedCause, ...] = (),
    among: tuple[str, ...] = (),
    best: Explanation | None = None,
) -> AnswerRecord:
    """Return the answer of a method that has a posterior over the library.

    Parameters
    ----------
    posterior
        Probabilities of explanations.
    verdict, named, among
        Verdict, named leaves or nodes, and names of the leaves that are not excluded.
    best
        Explanation whose sizes are given.
    """
    leaves = {posterior.entry(name).entry.path: own for name, own in posterior.leaves.items()}
    every = {NOTHING: posterior.nothing, SOMETHING_ELSE: posterior.unknown}
    every |= {**posterior.nodes, **leaves}
    return AnswerRecord(
        verdict=verdict,
        named=tuple(own.path for own in named),
        among=tuple(posterior.entry(name).entry.path for name in among),
        probabilities={
            path: float(np.clip(own, 0.0, 1.0))
            for path, own in every.items()
            if own >= LEAST_PROBABILITY
        },
        sizes={} if best is None or best.refit is None else _sizes(best),
    )


def _sizes(best: Explanation) -> dict[str, SizeRecord]:
    found = {}
    for suspect, values in zip(best.suspects, values_of(best).values(), strict=True):
        if len(values) == 1:
            value, low, high, _ = next(iter(values.values()))
            found[suspect.entry.path] = SizeRecord(
                value=float(value), low=float(low), high=float(high)
            )
    return found


def with_repair(
    made: AnswerRecord, comparison: HoldoutComparison | None, base: Refit, repair: Refit
) -> AnswerRecord:
    """Return an answer with held-out errors and board coefficients, without and with a repair."""
    board = base.fit.prior.slice_of('coefficients')
    boards = base.estimate.values, repair.estimate.values, repair.estimate.std
    before, after, std = (tuple(map(float, own[board])) for own in boards)
    update: dict[str, object] = {
        'coefficients': CoefficientsRecord(before=before, after=after, std=std)
    }
    if comparison is not None and comparison.after is not None:
        errors = comparison.before.rms, comparison.after.rms, comparison.before.expected
        parts = [{name: float(own) for name, own in error.items()} for error in errors]
        update['held_out'] = HeldOutRecord(before=parts[0], after=parts[1], expected=parts[2])
    return made.model_copy(update=update)
