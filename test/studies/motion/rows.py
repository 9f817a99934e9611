"""Figures of the trials: spread and coverage of both estimates, and errors in states not towed."""

from collections.abc import Sequence

import numpy as np
from scipy.special import chdtri
from scipy.stats import binomtest

from studies.motion.trial import MotionTrial
from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.estimation.fit.objective import PAPER_CHANNELS
from trawl_ros.lab.report.measured import MeasuredValue, at_most, between
from trawl_ros.lab.report.rates import AGAIN, figure_row
from trawl_ros.records.coefficients import COEFFICIENTS

COVERAGE = (92.0, 98.0)
"""Allowed coverage of 95 % intervals, %."""

MOST_SPREAD = 0.6
"""Std of all of the tow over that of its steady parts, at most."""

OVER_TRUTH, OVER_TRUTH_END = 1.1, 1.2
"""Errors in states not towed over those of the model with the true coefficients, at most, and the
upper end of their interval."""

ALPHA = 0.05

BAND = tuple(float(chdtri(len(COEFFICIENTS), tail)) for tail in (0.975, 0.025))
"""Band that holds 95 % of the squared normalised errors of twelve coefficients."""

WHO = ('its steady parts', 'all of the tow')


def motion_rows(trials: Sequence[MotionTrial], series: str, *, asked: bool) -> list[MeasuredValue]:
    """All figures of a series; ``asked`` with their targets."""
    if not trials:
        return [
            MeasuredValue(f'{series}: 95 % intervals that cover the truth', np.nan, note='none')
        ]
    return [
        _spread_row(trials, series, asked=asked),
        *(_coverage_row(trials, series, who, asked=asked) for who in (1, 0)),
        *(_worst_row(trials, series, who, asked=asked) for who in (1, 0)),
        *(_squared_row(trials, series, who) for who in (1, 0)),
        *(row for who in (1, 0) for row in _held_out_rows(trials, series, who, asked=asked)),
        *_rest_rows(trials, series),
    ]


def _spread_row(trials: Sequence[MotionTrial], series: str, *, asked: bool) -> MeasuredValue:
    std = np.log(_array(trials, 'std'))
    ratios = (std[:, 1] - std[:, 0]).mean(axis=1)

    each = np.exp((std[:, 1] - std[:, 0]).mean(axis=0))
    words = ', '.join(f'{n} {r:.2f}' for n, r in zip(COEFFICIENTS, each, strict=True))
    return figure_row(
        f'{series}: std of all of the tow over that of its steady parts, geometric mean',
        lambda some: float(np.exp(ratios[some].mean())),
        len(trials), '', at_most(MOST_SPREAD) if asked else None, words,
    )  # fmt: skip


def _coverage_row(
    trials: Sequence[MotionTrial], series: str, who: int, *, asked: bool
) -> MeasuredValue:
    inside = covered(trials, who)
    return figure_row(
        f'{series}: 95 % intervals of {WHO[who]} that cover the truth',
        lambda some: float(100.0 * inside[some].mean()),
        len(trials), '%', between(*COVERAGE) if asked else None,
        f'{int(inside.sum())} of {inside.size}; {AGAIN}',
    )  # fmt: skip


def covered(trials: Sequence[MotionTrial], who: int) -> FloatArray:
    """Flags (trials, 12) of the truths that lie within the intervals of an estimate."""
    low, high = (_array(trials, name)[:, who] for name in ('low', 'high'))
    truth = _array(trials, 'truth')
    return np.asarray((low <= truth) & (truth <= high), np.float64)


def _worst_row(
    trials: Sequence[MotionTrial], series: str, who: int, *, asked: bool
) -> MeasuredValue:
    """Number of coefficients whose coverage differs from 95 %, by Holm's step-down procedure."""
    counts = covered(trials, who).sum(axis=0).astype(int)
    chances = [binomtest(int(count), len(trials), 0.95).pvalue for count in counts]
    words = ', '.join(
        f'{name} {100.0 * count / len(trials):.0f}'
        for name, count in zip(COEFFICIENTS, counts, strict=True)
    )
    return MeasuredValue(
        f'{series}: coefficients whose coverage by {WHO[who]} is not 95 %, after Holm',
        differing(chances),
        target=at_most(0) if asked and who else None,
        note=f'at 5 % for all twelve together; coverage in %: {words}',
    )


def differing(chances: Sequence[float]) -> int:
    """Number of hypotheses that are rejected by Holm's procedure, by their p-values."""
    for done, rng in enumerate(sorted(chances)):
        if rng > ALPHA / (len(chances) - done):
            return done
    return len(chances)


def _squared_row(trials: Sequence[MotionTrial], series: str, who: int) -> MeasuredValue:
    squares = _array(trials, 'squared')[:, who]
    inside = int(np.sum((squares >= BAND[0]) & (squares <= BAND[1])))
    return figure_row(
        f'{series}: squared normalised error of twelve coefficients by {WHO[who]}, median',
        lambda some: float(np.median(squares[some])),
        len(trials), '', None,
        f'{inside} of {len(trials)} trials within {BAND[0]:.1f} to {BAND[1]:.1f}, where 95 % '
        f'belong; the median of right ones is 11.3; {AGAIN}',
    )  # fmt: skip


def _held_out_rows(
    trials: Sequence[MotionTrial], series: str, who: int, *, asked: bool
) -> list[MeasuredValue]:
    measured = _array(trials, 'measured')
    predicted = _array(trials, 'predicted')
    away = np.abs(predicted - measured[:, None])
    # Where the model has no steady state by one of the coefficients, no pair is compared.
    there = np.asarray(np.isfinite(away).all(axis=(1, 3)), np.bool_)
    wrong = np.where(there[:, None, :, None], away, 0.0).sum(axis=2)
    missing = int(np.sum(~there))
    rows = []
    for column, channel in enumerate(PAPER_CHANNELS):
        own = wrong[:, :, column]

        def figure(some: IntArray, own: FloatArray = own) -> float:
            return float(own[some, who].sum() / own[some, 2].sum())

        of = 100.0 * own[:, 2].sum() / np.abs(measured)[there][:, column].sum()
        rows.append(
            figure_row(
                f'{series}: states not towed, error in {channel.name.replace("_", " ")} by '
                f'{WHO[who]} over that by the truth',
                figure, len(trials), '', at_most(OVER_TRUTH) if asked and who else None,
                f'with the true coefficients the model is {of:.2f} % off'
                + (f'; {missing} states have no prediction' if missing else '')
                + f'; upper end at most {OVER_TRUTH_END:g}',
            )
        )  # fmt: skip
    return rows


def _rest_rows(trials: Sequence[MotionTrial], series: str) -> list[MeasuredValue]:
    learned = [trial for trial in trials if not trial.refused]
    rates = [trial.duration_s / trial.cpu_s for trial in trials]
    drawn = len(trials) + sum(sum(trial.rejected.values()) for trial in trials)
    left = sum(trial.left_out_s for trial in learned) / 60.0
    return [
        MeasuredValue(
            f'{series}: tows whose whole course was fitted',
            100.0 * len(learned) / len(trials), '%',
            note=f'{len(learned)} of {len(trials)}. The fit of the others did not converge; their '
            f'windows count, as in `trawl identify`. {left:.0f} min are left out, with beginnings',
        ),
        MeasuredValue(
            f'{series}: time towed over processor time of the fit, median', float(np.median(rates)),
            '', note='from the estimate of the windows on, states held out included',
            low=min(rates), high=max(rates),
        ),
        MeasuredValue(
            f'{series}: boards drawn that cannot be towed',
            100.0 * (1.0 - len(trials) / drawn), '%', note=f'of {drawn}; drawn again',
        ),
    ]  # fmt: skip


def _array(trials: Sequence[MotionTrial], name: str) -> FloatArray:
    return np.array([getattr(trial, name) for trial in trials], dtype=float)
