# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Baselines that a method should beat, each with the library of the project."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np
from scipy.special import logsumexp
from scipy.stats import f as f_distribution
from scipy.stats import norm

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.diagnosis.holdout import holdout_comparison, predicted, without_kept_back
from trawl_ros.diagnosis.inference.blocks import blocks_of
from trawl_ros.diagnosis.inference.candidates import signatures
from trawl_ros.diagnosis.inference.decision import Decision, NamedCause, decide
from trawl_ros.diagnosis.inference.marginal import Marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.posterior import Explanation, Posterior, weighted
from trawl_ros.diagnosis.inference.refit import Refit, fit_boards, refitted
from trawl_ros.diagnosis.inference.screen import Suspect, ready_for
from trawl_ros.diagnosis.locating import Where, located
from trawl_ros.estimation.fit.error_terms import group_of
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.estimation.windows.records import SteadyWindow
from trawl_ros.lab.missing_effect.prepared import Prepared, answer, with_repair
from trawl_ros.lab.missing_effect.records import NOTHING, SOMETHING_ELSE, AnswerRecord
from trawl_ros.records.channels import INPUTS

SENSOR_NODES = {
    'tension': 'instruments/load cells',
    'door_depth': 'instruments/depth sensors',
    'net_depth': 'instruments/depth sensors',
    'door_spread': 'instruments/spread sensor',
    'pitch': 'instruments/attitude sensors',
    'roll': 'instruments/attitude sensors',
    'vertical_opening': 'instruments/sonar',
    'divergence': 'instruments/angles of the warps',
    'declination': 'instruments/angles of the warps',
}
"""Node of the sensor of each quantity."""


@dataclass(frozen=True)
class BaselineOptions:
    """Options of the baselines, by convention, not fitted to any trial.

    Attributes
    ----------
    alarm
        Probability of a false alarm of all tests of a trial together.
    cut
        Probability from which a leaf or node is named.
    refits
        Number of the best sets that BIC refits.
    draws, most_terms
        Size of the ensemble of the sparse regression, and its largest number of terms.
    seed
        Seed of the ensemble.
    amplitudes, lengths
        Grid of the Gaussian process: amplitudes in std of a reading, length scales in std of the
        covariates.
    """

    alarm: float = 0.01
    cut: float = 0.95
    refits: int = 5
    draws: int = 50
    most_terms: int = 3
    seed: int = 0
    amplitudes: tuple[float, ...] = (1.0, 3.0, 10.0)
    lengths: tuple[float, ...] = (0.7, 1.5, 3.0)


def largest_residual(ready: Prepared, options: BaselineOptions) -> AnswerRecord:
    """Blame the sensor of the channel with the largest residual pattern, if it is significant."""
    largest: dict[str, Where] = {}
    places = located(ready.screen)
    for where in places:
        largest.setdefault(SENSOR_NODES[group_of(where.channel)], where)
    cut = float(norm.isf(0.5 * options.alarm / len(places)))
    weights = {node: 0.5 * (where.z**2 - cut**2) for node, where in largest.items()}
    weights[NOTHING] = 0.0
    whole = logsumexp(list(weights.values()))
    node = max(largest, key=lambda own: abs(largest[own].z))
    alarm = abs(largest[node].z) > cut
    return AnswerRecord(
        verdict='NAMED' if alarm else 'NO_DISCREPANCY',
        named=(node,) if alarm else (),
        among=tuple(
            suspect.entry.path
            for suspect in ready.screen.suspects
            if alarm and suspect.entry.node.path == node
        ),
        probabilities={own: float(np.exp(weight - whole)) for own, weight in weights.items()},
    )


def bic(ready: Prepared, options: BaselineOptions) -> AnswerRecord:
    """Weigh the causes of the library, and pairs with the best, by BIC; the best are refitted."""
    screen, found = ready.screen, ready.screen.marginal
    readings = np.log(sum(len(linear.channels) for linear in screen.fit.windows))

    def first_order(key: tuple[int, ...]) -> float:
        places = [own for place in key for own in _places(screen.suspects[place])]
        return found.chi2(places) - len(places) * float(readings)

    gains: dict[tuple[int, ...], float] = {
        (place,): first_order((place,)) for place in range(len(screen.suspects))
    }
    (best,) = max(gains, key=lambda key: gains[key])
    name = screen.suspects[best].candidate.name
    for place, suspect in enumerate(screen.suspects):
        if suspect.candidate.name != name:
            gains[tuple(sorted((best, place)))] = first_order((best, place))
    refits: dict[tuple[int, ...], Refit | None] = {}
    for key in sorted(gains, key=lambda own: -gains[own])[: options.refits]:
        refits[key] = own = _refitted(ready, [screen.suspects[place] for place in key])
        gains[key] = -np.inf
        if own is not None:
            delta = 2.0 * (ready.base.cost(screen.fit.scales) - own.cost(screen.fit.scales))
            gains[key] = delta - own.number * float(readings)
    made, decision = _decided(
        [
            Explanation(
                tuple(screen.suspects[own] for own in key), 0.5 * gain, 0.0, refits.get(key)
            )
            for key, gain in (((), 0.0), *gains.items())
            if np.isfinite(gain)
        ],
        options,
    )
    if decision.verdict != 'NAMED' or decision.best is None or decision.best.refit is None:
        return made
    repair = decision.best.refit
    predictor = ready_for(ready.predictor, [own.effect for own in repair.wanted])
    alone, repaired = (without_kept_back(own, ready.halves) for own in (ready.base, repair))
    comparison = holdout_comparison(predictor, alone, repaired, None, ready.halves.kept_back)
    return with_repair(made, comparison, ready.base, repair)


def _decided(
    explanations: Sequence[Explanation], options: BaselineOptions
) -> tuple[AnswerRecord, Decision]:
    """Decide on weighted explanations by the same rule as the diagnosis."""
    posterior = Posterior(weighted(explanations, 1.0))
    made = decide(posterior, InferenceOptions(cut=options.cut))
    return answer(posterior, made.verdict, made.named, made.among, made.best), made


def _places(suspect: Suspect) -> list[int]:
    return [suspect.block[place] for place in suspect.entry.places]


def _refitted(ready: Prepared, suspects: Sequence[Suspect]) -> Refit | None:
    screen = ready.screen
    away = np.zeros(screen.number)
    free = [place for suspect in suspects for place in _places(suspect)]
    away[free] = screen.marginal.values(free)
    places = [place for suspect in suspects for place in suspect.block]
    wanted = [suspect.candidate for suspect in suspects]
    predictor = ready_for(ready.predictor, [one.effect for one in wanted])
    columns = [own[:, places] for own in screen.columns]
    return refitted(predictor, ready.base, wanted, columns, away[places])


def clean_regime(ready: Prepared, options: BaselineOptions) -> AnswerRecord:
    """Fit boards to the clean regime; select a cause by hold-out, and confirm it by an F-test.

    The recipe of LISDD (arXiv 2606.23215) with the baseline tows as the clean regime, or all
    windows without a baseline. The boards are held. Each cause is fitted to one half of the
    examined windows that are not held out and predicts the other half. The one with the least
    error is confirmed on the held-out windows.
    """
    in_baseline = [own for own in ready.halves.fitted if own.tow in ready.data.baseline]
    prior = board_prior(ready.data.gear)
    fitted = fit_boards(ready.predictor, prior, in_baseline) if in_baseline else None
    clean = fitted or ready.base
    examined = [own for own in ready.halves.fitted if own.tow not in ready.data.baseline]
    parts = [
        _whitened(ready, clean, windows)
        for windows in (examined[::2], examined[1::2], ready.halves.kept_back)
    ]
    halves, tested = [own for own in parts[:2] if own], parts[2]
    suspects = ready.screen.suspects
    if len(halves) < 2 or tested is None:
        return AnswerRecord(verdict='NOT_TESTABLE')
    errors = [
        sum(_error(places, *pair) for pair in permutations(halves, 2))
        for places in ([], *map(_places, suspects))
    ]
    explanations = [
        Explanation(own, 0.0, -0.5 * error)
        for own, error in zip(((), *((one,) for one in suspects)), errors, strict=True)
    ]
    posterior = Posterior(weighted(explanations, 1.0))
    best = suspects[int(np.argmin(errors[1:]))]
    number, readings = len(_places(best)), len(tested[1])
    without, left = _error([], tested, tested), _error(_places(best), tested, tested)
    ratio = (without - left) / number / (left / (readings - number))
    if f_distribution.sf(ratio, number, readings - number) > options.alarm:
        return answer(posterior, 'NO_DISCREPANCY')
    name = best.entry.name
    named = NamedCause(best.entry.path, posterior.leaves[name], (name,))
    return answer(posterior, 'NAMED', (named,), (name,))


Rows = tuple[FloatArray, FloatArray]
"""Columns (n, values) and residuals (n,) of windows, whitened."""


def _error(places: Sequence[int], fitted: Rows, tested: Rows) -> float:
    """Return the sum of squares that a cause leaves on some rows when it is fitted to others."""
    columns = fitted[0][:, places]
    left = tested[1] - tested[0][:, places] @ (np.linalg.pinv(columns, 1e-8) @ fitted[1])
    return float(left @ left)


def _whitened(ready: Prepared, clean: Refit, windows: Sequence[SteadyWindow]) -> Rows | None:
    """Whiten the rows of windows, with the boards held; None without any."""
    rows = list(_linearised(ready, clean, windows))
    if not rows:
        return None
    wanted = [suspect.candidate for suspect in ready.screen.suspects]
    predictor = ready_for(ready.predictor, [one.effect for one in wanted])
    units = np.concatenate([one.scale for one in wanted])
    columns = [own * units for own in signatures(predictor, rows, wanted)]
    fit = replace(
        clean.fit, windows=tuple(rows), coefficients=clean.estimate.values, weights=None, known=None
    )
    blocks = blocks_of(fit, columns, errors=InferenceOptions().errors)
    boards = fit.prior.slice_of('coefficients')
    away = fit.prior.departure(fit.coefficients)[boards]
    return blocks.columns, blocks.residual - blocks.shared[:, boards] @ away


def _linearised(
    ready: Prepared, clean: Refit, windows: Sequence[SteadyWindow]
) -> Iterator[Linearised]:
    for window in windows:
        try:
            yield predicted(ready.predictor, clean, window)
        except NoSteadyState:
            continue


def sparse_regression(ready: Prepared, options: BaselineOptions) -> AnswerRecord:
    """Add terms of the library to the residuals while they are significant, over an ensemble.

    Forward regression orthogonal least squares, an optimiser of SINDy (de Silva et al. 2020), with
    inclusion probabilities of an ensemble (Fasel et al. 2022). Each draw adds noise of the
    readings; a term is significant with Bonferroni's correction for the library.
    """
    screen, rng = ready.screen, np.random.default_rng(options.seed)
    owner = [suspect for suspect in screen.suspects for _ in suspect.block]
    free = [place for suspect in screen.suspects for place in _places(suspect)]
    found = screen.marginal.of(free)
    values, vectors = np.linalg.eigh(found.information)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    cut = float(norm.isf(0.5 * options.alarm / len(free))) ** 2
    by_name = {suspect.entry.name: suspect for suspect in screen.suspects}
    sets: Counter[tuple[str, ...]] = Counter()
    for _ in range(options.draws):
        noise = root @ rng.standard_normal(len(free))
        terms = _forward(Marginal(found.information, found.score + noise), cut, options.most_terms)
        sets[tuple(sorted({owner[free[term]].entry.name for term in terms}))] += 1
    explanations = [
        Explanation(tuple(by_name[name] for name in names), 0.0, float(np.log(count)))
        for names, count in sets.items()
    ]
    return _decided(explanations, options)[0]


def _forward(found: Marginal, cut: float, most: int) -> list[int]:
    terms: list[int] = []
    while len(terms) < most:
        information = np.diag(found.information)
        gains = np.where(information > 1e-9, found.score**2 / np.maximum(information, 1e-9), 0.0)
        gains[terms] = 0.0
        place = int(np.argmax(gains))
        if gains[place] < cut:
            break
        terms.append(place)
        found = found.without([place])
    return terms


def gaussian_process(ready: Prepared, options: BaselineOptions) -> AnswerRecord:
    """Fit a Gaussian process to the residuals of each channel; it fits, but cannot name.

    Its covariates are warp length, speed, hours and course; it is zero in the baseline. The odds of
    a discrepancy are the product over channels of the mean of 1 and the Bayes factor.
    """
    windows = ready.base.fit.windows
    x = np.array([
        (own.inputs[:2].mean(), own.inputs[2], own.window.hours, own.window.sense)
        for own in windows
    ])  # fmt: skip
    x = (x - x.mean(axis=0)) / np.maximum(x.std(axis=0), 1e-9)
    distance = ((x[:, None] - x[None]) ** 2).sum(axis=-1)
    examined = np.array([own.window.tow not in ready.data.baseline for own in windows])
    odds = 0.0
    for name in dict.fromkeys(name for own in windows for name in own.channels):
        rows = [row for row, own in enumerate(windows) if name in own.channels]
        places = [windows[row].channels.index(name) for row in rows]
        chosen = [(windows[row], place) for row, place in zip(rows, places, strict=True)]
        away = np.array([
            (own.measured - own.predicted(ready.base.fit.coefficients))[place]
            for own, place in chosen
        ])  # fmt: skip
        noise = _noise(name, chosen)
        std = float(np.sqrt(np.median(np.diag(noise))))
        both = np.outer(examined[rows], examined[rows])
        gains = [
            _log_normal(away, noise + (size * std) ** 2 * both * np.exp(
                -0.5 * distance[np.ix_(rows, rows)] / length**2))
            for size in options.amplitudes
            for length in options.lengths
        ]  # fmt: skip
        factor = logsumexp(gains) - np.log(len(gains)) - _log_normal(away, noise)
        odds += float(np.logaddexp(0.0, factor) - np.log(2.0))
    probability = float(1.0 / (1.0 + np.exp(-np.clip(odds, -500.0, 500.0))))
    return AnswerRecord(
        verdict='UNKNOWN' if probability >= options.cut else 'NO_DISCREPANCY',
        probabilities={NOTHING: 1.0 - probability, SOMETHING_ELSE: probability},
    )


def _noise(name: str, chosen: Sequence[tuple[Linearised, int]]) -> FloatArray:
    """Covariance (n, n) of a channel's errors: calibration of each tow, noise, and inputs."""
    tows = np.array([own.window.tow for own, _ in chosen])
    bias = np.array([own.window.bias[name] for own, _ in chosen])
    inputs = np.array([
        own.by_inputs[place] @ np.diag([own.window.std(one) ** 2 for one in INPUTS])
        @ own.by_inputs[place]
        for own, place in chosen
    ])  # fmt: skip
    own_noise = np.array([own.window.std(name) ** 2 for own, _ in chosen]) - bias**2
    shared = np.outer(bias, bias) * (tows[:, None] == tows[None])
    covariance: FloatArray = shared + np.diag(own_noise + inputs)
    return covariance


def _log_normal(values: FloatArray, covariance: FloatArray) -> float:
    root = np.linalg.cholesky(covariance)
    white = np.linalg.solve(root, values)
    return float(-0.5 * white @ white - np.log(np.diag(root)).sum())
