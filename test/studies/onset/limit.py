"""Limit beyond which findings are raised, from innovations that are white and of unit size.

A clean tow is watched once, which tells what marks the candidates leave; then innovations are drawn
many times, and the rarest candidate of each tow is noted. Beyond what drawing shows the tail is
taken as exponential, of the rarest tenth.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from studies.onset.trial import clean_marks
from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.onset.candidates import CandidateTable, candidate_table
from trawl_ros.diagnosis.onset.part import LIVE
from trawl_ros.diagnosis.onset.ratios import FEWEST

TAIL = 0.1
"""Part of the rarest by which the tail is told."""


@dataclass(frozen=True)
class DrawnLimit:
    """Limit for a rate of false findings.

    Attributes
    ----------
    hours
        Hours drawn.
    largest
        Rarest in all of them.
    limit
        Rarity that is exceeded once in so many hours as are asked for.
    """

    hours: float
    largest: float
    limit: float


def drawn_limit(gear: str, seed: int, minutes: float, draws: int, asked_h: float) -> DrawnLimit:
    """Limit that white innovations exceed once in ``asked_h`` hours.

    Parameters
    ----------
    gear, seed, minutes
        Of the clean tow.
    draws
        Of its innovations.
    asked_h
        Hours of tow.
    """
    table = candidate_table()
    marks = clean_marks(gear, seed, minutes)
    rarest = drawn_rarest(table, marks, draws, np.random.default_rng([seed, draws]))
    hours_each = len(marks) * LIVE.stretch_s / 3600.0
    tail = np.sort(rarest)[-max(round(TAIL * draws), 2) :]
    mean = float(np.mean(tail - tail[0]))
    part = len(tail) / draws
    limit = tail[0] + mean * np.log(max(asked_h / hours_each * part, 1.0))
    return DrawnLimit(draws * hours_each, float(rarest.max()), float(limit))


def drawn_rarest(
    table: CandidateTable, marks: Iterable[FloatArray], draws: int, rng: np.random.Generator
) -> FloatArray:
    """Rarity (draws,) of the rarest candidate and onset in a tow of white innovations.

    Parameters
    ----------
    table
        Candidates of the p columns.
    marks
        Of each stretch (w, r, p), by age of the onset.
    draws
        Of the innovations.
    """
    p = len(table.parameters)
    low, high = table.reach
    rarest = np.zeros(draws)
    products: FloatArray = np.zeros((0, 0, p))
    squares: FloatArray = np.zeros((0, p, p))
    for known, own in enumerate(marks, start=1):
        window = len(own)
        if known == 1:
            products, squares = np.zeros((draws, window, p)), np.zeros((window, p, p))
        for array in (products, squares[None]):
            array[:, 1:] = array[:, :-1].copy()
            array[:, 0] = 0.0
        told = rng.standard_normal((draws, own.shape[1]))
        products += np.einsum('wrp,nr->nwp', own, told, optimize=True)
        squares += np.matmul(np.swapaxes(own, 1, 2), own)
        ages = np.arange(FEWEST - 1, min(known, window))
        if not len(ages):
            continue
        for candidate in table.candidates:
            columns = list(candidate.columns)
            informed = squares[ages][:, columns][:, :, columns]
            informed = informed + np.diag(table.scale[columns] ** -2.0)
            b = products[:, ages][:, :, columns]
            values = np.einsum('wpq,nwq->nwp', np.linalg.inv(informed), b)
            values = np.clip(values, low[columns], high[columns])
            curved = np.einsum('nwp,wpq,nwq->nw', values, informed, values, optimize=True)
            ratios = np.max(2.0 * np.sum(values * b, axis=2) - curved, axis=1)
            rarest = np.maximum(rarest, -chi2.logsf(ratios, len(columns)) / np.log(10.0))
    return rarest
