"""Figures of the trials: coverage, spread beside its bound, errors on tows left out."""

from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from scipy.stats import binomtest

from trawl_ros.identification.objective import PAPER_CHANNELS
from trawl_ros.identification.prior import BoardPrior
from trawl_ros.model.board import COEFFICIENTS
from trawl_ros.studies.identification.trial import Trial
from trawl_ros.studies.row import Row

COVERAGE = (90.0, 98.0)
"""What 95 % intervals may cover, %."""

SPREAD = (0.9, 1.2)
"""Spread of estimates over its bound."""

MOST_ERROR = {'door_spread': 2.4, 'door_depth': 2.2, 'net_depth': 3.7, 'warp_tension': 1.3}
"""Errors on tows left out, %: half of the paper's."""

OVER_FLOOR = 1.2
"""How much larger than that of a perfect model they may be."""

DRAWN_AGAIN = 2000
SEED = 7


def coverage_rows(trials: Sequence[Trial], series: str, *, asked: bool) -> list[Row]:
    """Share of truths inside the intervals, of all coefficients together and of each."""
    least, most = COVERAGE if asked else (None, None)
    truth, low, high = (_array(trials, name) for name in ('truth', 'low', 'high'))
    inside = (low <= truth) & (truth <= high)
    together = _interval(lambda some: 100.0 * inside[some].mean(), len(trials))
    rows = [
        Row(
            f'{series}: 95 % intervals that cover the truth',
            100.0 * inside.mean() if len(trials) else np.nan,
            low=together[0],
            high=together[1],
            unit='%',
            least=least,
            target=most,
            note=f'all twelve of {len(trials)} trials; interval by drawing trials again',
        )
    ]
    if not asked:
        return rows
    for column, name in enumerate(COEFFICIENTS):
        count = int(inside[:, column].sum())
        ends = (
            binomtest(count, len(trials)).proportion_ci(method='exact')
            if len(trials)
            else (np.nan, np.nan)
        )
        rows.append(
            Row(
                f'{series}: intervals of {name} that cover the truth',
                100.0 * count / len(trials) if len(trials) else np.nan,
                low=100.0 * ends[0],
                high=100.0 * ends[1],
                unit='%',
                least=least,
                target=most,
                note='binomial 95 % interval (Clopper and Pearson)',
            )
        )
    return rows


def spread_rows(trials: Sequence[Trial], prior: BoardPrior) -> list[Row]:
    """Root mean square error over the Bayesian Cramér–Rao bound (Van Trees)."""
    if not trials:
        return [Row('spread of estimates over its bound', np.nan, note='no trials')]
    error = _array(trials, 'values') - _array(trials, 'truth')
    known = np.array([trial.information for trial in trials])
    before = np.diag(prior.std**-2)

    def ratio(some: np.ndarray) -> np.ndarray:
        bound = np.linalg.inv(known[some].mean(axis=0) + before)
        return np.sqrt((error[some] ** 2).mean(axis=0) / np.diag(bound))

    everything = np.arange(len(trials))
    at_hand = np.sqrt(np.diagonal(np.linalg.inv(known + before), axis1=1, axis2=2))

    def overall(some: np.ndarray) -> float:
        return float(np.sqrt(np.mean(ratio(some) ** 2)))

    def by_board(some: np.ndarray) -> float:
        return float(np.sqrt(np.mean((error[some] / at_hand[some]) ** 2)))

    def one(column: int, some: np.ndarray) -> float:
        return float(ratio(some)[column])

    least, most = SPREAD
    rows = [
        Row(
            'spread of estimates over its bound',
            overall(everything),
            *_interval(overall, len(trials)),
            least=least,
            target=most,
            note=f'root mean square of the twelve ratios, {len(trials)} trials; Van Trees: '
            'the inverse of the mean information of data and prior',
        ),
        Row(
            'spread of estimates over the bound of each board',
            by_board(everything),
            *_interval(by_board, len(trials)),
            note='error of each trial over the bound from the information at its own truth, which '
            'is the larger of the two bounds',
        ),
    ]
    for column, name in enumerate(COEFFICIENTS):
        rows.append(
            Row(
                f'spread of {name} over its bound',
                one(column, everything),
                *_interval(partial(one, column), len(trials)),
                least=least,
                target=most,
                note='interval by drawing trials again',
            )
        )
    return rows


def held_out_rows(trials: Sequence[Trial]) -> list[Row]:
    """Errors on tows left out, and how they compare with a perfect model's."""
    rows = []
    measured, predicted, perfect = (
        _array(trials, name).reshape(len(trials), -1, len(PAPER_CHANNELS))
        for name in ('measured', 'predicted', 'perfect')
    )
    usable = np.isfinite(predicted)
    missing = int(np.sum(~np.all(usable, axis=2)))
    for column, channel in enumerate(PAPER_CHANNELS):
        there = usable[:, :, column]
        seen = np.where(there, measured[:, :, column], 0.0)
        wrong = np.where(there, np.abs(predicted[:, :, column] - measured[:, :, column]), 0.0)
        least = np.where(there, np.abs(perfect[:, :, column] - measured[:, :, column]), 0.0)

        def error(some: np.ndarray, of: np.ndarray = wrong, by: np.ndarray = seen) -> float:
            return float(100.0 * of[some].sum() / by[some].sum())

        def beyond(some: np.ndarray, of: np.ndarray = wrong, by: np.ndarray = least) -> float:
            return float(of[some].sum() / by[some].sum())

        name = channel.name.replace('_', ' ')
        everything = np.arange(len(trials))
        floor = error(everything, least) if len(trials) else np.nan
        rows += [
            Row(
                f'tows left out: error in {name}',
                error(everything) if len(trials) else np.nan,
                *_interval(error, len(trials)),
                unit='%',
                target=MOST_ERROR[channel.name],
                note='mean error over mean measured value'
                + (f'; {missing} states have none in the fitted model' if missing else ''),
            ),
            Row(
                f'tows left out: error in {name} over that of a perfect model',
                beyond(everything) if len(trials) else np.nan,
                *_interval(beyond, len(trials)),
                target=OVER_FLOOR,
                note=f'the plant itself, at inputs as measured, is {floor:.2f} % off for noise '
                'and biases of these tows',
            ),
        ]
    return rows


def board_rows(trials: Sequence[Trial]) -> list[Row]:
    """How many fits came to rest, and how many boards could not be towed."""
    rejected = sum((Counter(trial.rejected) for trial in trials), Counter[str]())
    reasons = ', '.join(f'{reason} {count}' for reason, count in rejected.most_common())
    drawn = len(trials) + rejected.total()
    rest = [trial.converged for trial in trials]
    return [
        Row(
            'fits that came to rest',
            100.0 * float(np.mean(rest)) if trials else np.nan,
            unit='%',
            note=f'{sum(rest)} of {len(rest)}; those that did not count in all figures',
        ),
        Row(
            'boards drawn from the prior that cannot be towed',
            100.0 * rejected.total() / drawn if drawn else np.nan,
            unit='%',
            note=f'of {drawn}; drawn again ({reasons or "none"})',
        ),
    ]


def _array(trials: Sequence[Trial], name: str) -> np.ndarray:
    found = np.array([getattr(trial, name) for trial in trials], dtype=float)
    return found if len(trials) else np.zeros((0, len(COEFFICIENTS)))


def _interval(figure: Callable[[np.ndarray], float], number: int) -> tuple[float, float]:
    """A 95 % interval of a figure of trials, by drawing as many of them again and again."""
    if number < 2:
        return np.nan, np.nan
    chance = np.random.default_rng(SEED)
    found = [figure(chance.integers(number, size=number)) for _ in range(DRAWN_AGAIN)]
    low, high = np.percentile(found, (2.5, 97.5))
    return float(low), float(high)
