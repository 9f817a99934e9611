"""Figures of the trials: coverage, spread beside its bound, errors on tows left out."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from studies.coverage.trial import EstimationTrial
from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.lab.report.measured import MeasuredValue, at_most, between
from trawl_ros.lab.report.rates import AGAIN, figure_row, interval, rate
from trawl_ros.records.coefficients import COEFFICIENTS

COVERAGE = (90.0, 98.0)
"""Allowed coverage of 95 % intervals, %."""

SPREAD = (0.9, 1.2)
"""Spread of estimates over its bound."""

MOST_ERROR = {'door_spread': 2.4, 'door_depth': 2.2, 'net_depth': 3.7, 'warp_tension': 1.3}
"""Errors on tows left out, %: half of the paper's."""

OVER_FLOOR = 1.2
"""Largest allowed ratio to the errors of a perfect model."""


def coverage_rows(
    trials: Sequence[EstimationTrial], series: str, *, asked: bool
) -> list[MeasuredValue]:
    """Share of truths inside the intervals, of all coefficients together and of each."""
    if not trials:
        return [
            MeasuredValue(
                f'{series}: 95 % intervals that cover the truth', np.nan, note='no trials'
            )
        ]
    target = between(*COVERAGE) if asked else None
    truth, low, high = (_array(trials, name) for name in ('truth', 'low', 'high'))
    inside = (low <= truth) & (truth <= high)
    rows = [
        figure_row(
            f'{series}: 95 % intervals that cover the truth',
            lambda some: float(100.0 * inside[some].mean()),
            len(trials),
            '%',
            target,
            f'all twelve of {len(trials)} trials; {AGAIN}',
        )
    ]
    if not asked:
        return rows
    for column, name in enumerate(COEFFICIENTS):
        what = f'{series}: intervals of {name} that cover the truth'
        rows.append(rate(what, inside[:, column].tolist(), least=COVERAGE[0], most=COVERAGE[1]))
    return rows


OTHER_BOUND = (1, 2, 3)
"""Places of rows that explain, and of which nothing is asked."""


def spread_rows(trials: Sequence[EstimationTrial], prior: ParameterVector) -> list[MeasuredValue]:
    """Root mean square error over the Bayesian Cramér–Rao bound (Van Trees)."""
    if not trials:
        return [MeasuredValue('spread of estimates over its bound', np.nan, note='no trials')]
    error = _array(trials, 'values') - _array(trials, 'truth')
    known = np.array([trial.information for trial in trials])
    before = np.diag(prior.std**-2)

    def ratio(some: IntArray) -> FloatArray:
        bound = np.linalg.inv(known[some].mean(axis=0) + before)
        found: FloatArray = np.sqrt((error[some] ** 2).mean(axis=0) / np.diag(bound))
        return found

    at_hand = np.sqrt(np.diagonal(np.linalg.inv(known + before), axis1=1, axis2=2))

    def figures(some: IntArray) -> FloatArray:
        """The figures over all coefficients, and the ratio of each (16,)."""
        each = ratio(some)
        by_trial = np.mean((error[some] / at_hand[some]) ** 2, axis=1)
        bound = np.linalg.inv(known[some].mean(axis=0) + before)
        beyond = np.mean(at_hand[some] ** 2, axis=0) / np.diag(bound)
        over_all = (np.mean(each**2), np.mean(by_trial), np.median(by_trial), np.mean(beyond))
        return np.array([*np.sqrt(over_all), *each])

    values = figures(np.arange(len(trials)))
    ends = interval(figures, len(trials))
    texts = [
        (
            'spread of estimates over its bound',
            f'root mean square of the twelve ratios, {len(trials)} trials; Van Trees: the inverse '
            'of the mean information of data and prior',
        ),
        (
            'spread of estimates over the bound of each board',
            'error of each trial over the bound from the information at its own truth, which is '
            'the larger of the two bounds',
        ),
        (
            'spread of estimates over the bound of each board, the median trial',
            'root mean square of the twelve in each trial',
        ),
        (
            'bound of each board over that of all',
            'what spread over the first bound would be if every trial reached its own: boards near '
            'their stall are seen far worse than the mean of all information says',
        ),
        *((f'spread of {name} over its bound', AGAIN) for name in COEFFICIENTS),
    ]
    return [
        MeasuredValue(
            what,
            float(value),
            # Only one of the two bounds is what was asked for.
            target=None if place in OTHER_BOUND else between(*SPREAD),
            note=note,
            low=float(low),
            high=float(high),
        )
        for place, ((what, note), value, low, high) in enumerate(
            zip(texts, values, *ends, strict=True)
        )
    ]


def held_out_rows(trials: Sequence[EstimationTrial]) -> list[MeasuredValue]:
    """Errors on tows left out, and how they compare with a perfect model's."""
    if not trials:
        return [MeasuredValue('tows left out: error', np.nan, note='no trials')]
    channels = len(PAPER_CHANNELS)
    measured, predicted, perfect = (
        _array(trials, name).reshape(len(trials), -1, channels)
        for name in ('measured', 'predicted', 'perfect')
    )
    there = np.isfinite(predicted)
    missing = int(np.sum(~np.all(there, axis=2)))
    size, wrong, least = (
        np.where(there, np.abs(part), 0.0).sum(axis=1)
        for part in (measured, predicted - measured, perfect - measured)
    )

    def figures(some: IntArray) -> FloatArray:
        """Per channel the error in %, and that over the one of a perfect model (2, n)."""
        of, by, floor = wrong[some].sum(axis=0), size[some].sum(axis=0), least[some].sum(axis=0)
        return np.array([100.0 * of / by, of / floor])

    errors, beyond = figures(np.arange(len(trials)))
    floors = errors / beyond
    low, high = interval(figures, len(trials))
    rows = []
    for column, channel in enumerate(PAPER_CHANNELS):
        name = channel.name.replace('_', ' ')
        rows += [
            MeasuredValue(
                f'tows left out: error in {name}',
                float(errors[column]),
                '%',
                at_most(MOST_ERROR[channel.name]),
                'mean error over mean measured value'
                + (f'; {missing} states have none in the fitted model' if missing else ''),
                low=float(low[0, column]),
                high=float(high[0, column]),
            ),
            MeasuredValue(
                f'tows left out: error in {name} over that of a perfect model',
                float(beyond[column]),
                target=at_most(OVER_FLOOR),
                note=f'the plant itself, at inputs as measured, is {floors[column]:.2f} % off for '
                'noise and biases of these tows',
                low=float(low[1, column]),
                high=float(high[1, column]),
            ),
        ]
    return rows


def board_rows(trials: Sequence[EstimationTrial]) -> list[MeasuredValue]:
    """Convergence of fits, and rate of boards that could not be towed."""
    rejected = sum((Counter(trial.rejected) for trial in trials), Counter[str]())
    reasons = ', '.join(f'{reason} {count}' for reason, count in rejected.most_common())
    drawn = len(trials) + rejected.total()
    rest = [trial.converged for trial in trials]
    return [
        MeasuredValue(
            'fits that came to rest',
            100.0 * float(np.mean(rest)) if trials else np.nan,
            '%',
            note=f'{sum(rest)} of {len(rest)}; those that did not count in all figures',
        ),
        MeasuredValue(
            'boards drawn from the prior that cannot be towed',
            100.0 * rejected.total() / drawn if drawn else np.nan,
            '%',
            note=f'of {drawn}; drawn again ({reasons or "none"})',
        ),
    ]


def _array(trials: Sequence[EstimationTrial], name: str) -> FloatArray:
    return np.array([getattr(trial, name) for trial in trials], dtype=float)
