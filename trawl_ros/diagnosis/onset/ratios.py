# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Likelihood ratios of what may have begun, over all onsets in a window.

Window-limited generalised likelihood ratios (Willsky and Jones, IEEE Trans. Automat. Contr. 21,
1976; Lai, IEEE Trans. Inf. Theory 44, 1998): the marks that a signature leaves in the innovations
are correlated with these, for each onset.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri, gammaln, log_ndtr, logsumexp, xlogy

from trawl_ros.core.arrays import FloatArray, IntArray, Slice
from trawl_ros.diagnosis.onset.candidates import CandidateTable, OnsetCandidate
from trawl_ros.diagnosis.onset.chain import Link

FEWEST = 2
"""Stretches since an onset, at least, before it counts."""

MOVING = 6.0
"""Rarity that an onset needs beyond the limit in a manoeuvre; it fades with the unrest. What boards
near their stall do then is beyond the derivatives, and looks like something that begins. Chosen on
tows of development seeds: docs/studies/lessons.md."""

NEAR = float(chdtri(1, 0.05))
"""Difference from the largest ratio that 95 % of the likelihood do not exclude."""


@dataclass(frozen=True)
class OnsetEvidence:
    """Evidence for one candidate.

    Attributes
    ----------
    candidate
        The candidate.
    age
        Stretches since the likeliest onset, that in which it began among them.
    ratio
        Twice the logarithm of the likelihood ratio.
    rarity
        -log10 of the probability of as much at one onset without any effect, at the onset at which
        it is largest less what is asked for beyond the limit (`MOVING`).
    values, covariance
        Departures (m,) from neutral, and their covariance (m, m).
    ages : (n,) int array
        Of the onsets that 95 % of the likelihood do not exclude.
    """

    candidate: OnsetCandidate
    age: int
    ratio: float
    rarity: float
    values: FloatArray
    covariance: FloatArray
    ages: IntArray


class RatioBank:
    """Bank of likelihood ratios, one per candidate and onset.

    Parameters
    ----------
    table
        The candidates.
    window
        Onsets w that are kept, in stretches.

    Attributes
    ----------
    products : (w, p) array
        Of marks and innovations, by age of the onset.
    squares : (w, p, p) array
        Of marks.
    """

    def __init__(self, table: CandidateTable, window: int) -> None:
        self.table, p = table, len(table.parameters)
        self.products, self.squares = np.zeros((window, p)), np.zeros((window, p, p))
        self._asked = np.zeros(window)
        # Rows of each stretch in the chain, and its marks (r, w, p) by age of the onset then.
        self._marks: deque[tuple[Slice, FloatArray]] = deque(maxlen=window - 1)
        self.known = 0

    def step(self, link: Link, signatures: FloatArray, unrest: float) -> FloatArray:
        """Advance by a stretch, in which another onset may lie.

        Parameters
        ----------
        link
            The stretch in the chain, without rows where nothing was compared.
        signatures : (w, r, p) array
            Of the stretch, by age of the onset.
        unrest
            1 in a manoeuvre, from which it fades.

        Returns
        -------
        array
            Marks (w, r, p) of the signatures in the innovations, of unit size.
        """
        for array in (self.products, self.squares, self._asked):
            array[1:] = array[:-1].copy()
            array[0] = 0.0
        self._asked[0] = MOVING * unrest
        if unrest == 1.0:
            # An onset just before shows by what moved alone.
            self._asked[: 1 + FEWEST] = MOVING
        self.known = min(self.known + 1, len(self.products))
        own = np.moveaxis(signatures, 1, 0).copy()
        # Before the first onset that is known there is none.
        own[:, self.known :] = 0.0
        for late, (place, marks) in enumerate(reversed(self._marks), start=1):
            own[:, late:] -= np.tensordot(link.back[:, place], marks[:, :-late], 1)
        found = link.whitened(own)
        self._marks.append((link.place, found))
        marks = np.moveaxis(found, 1, 0) * link.weights[:, None]
        self.products += np.einsum('wrp,r->wp', marks, link.innovations)
        self.squares += np.matmul(np.swapaxes(marks, 1, 2), marks)
        return marks

    def forget(self) -> None:
        """Discard all onsets so far."""
        self.products[:], self.squares[:], self.known = 0.0, 0.0, 0
        self._marks.clear()

    def best(self) -> list[OnsetEvidence]:
        """Evidence for each candidate at its likeliest onset; the rarest first."""
        if self.known < FEWEST:
            return []
        ages = np.arange(FEWEST - 1, self.known)
        found = (self._evidence(candidate, ages) for candidate in self.table.candidates)
        return sorted(found, key=lambda one: -one.rarity)

    def _evidence(self, candidate: OnsetCandidate, ages: IntArray) -> OnsetEvidence:
        """Return the evidence for a candidate at the likeliest of some onsets."""
        own = list(candidate.columns)
        products, squares = self.products[ages][:, own], self.squares[ages][:, own][:, :, own]
        informed = squares + np.diag(self.table.scale[own] ** -2.0)
        values = np.linalg.solve(informed, products[..., None])[..., 0]
        values = np.clip(values, *self.table.reach[:, own])
        left = 2.0 * products - np.einsum('wpq,wq->wp', informed, values)
        ratios = np.einsum('wp,wp->w', values, left)
        best = int(np.argmax(ratios))
        worth = ratios - 2.0 * np.log(10.0) * self._asked[ages]
        return OnsetEvidence(
            candidate, int(ages[best]), float(ratios[best]), rarity(np.max(worth), len(own)),
            values[best], np.linalg.inv(informed[best]), ages[ratios >= ratios[best] - NEAR],
        )  # fmt: skip


def rarity(ratio: float, freedom: int) -> float:
    """-log10 of the probability of as large a ratio without any effect.

    The survival function of χ² is a finite sum (Abramowitz and Stegun 26.4.4 and 26.4.5), taken in
    logarithms: what is rarer than the smallest number still has its rarity.
    """
    # Values at their bounds may make a ratio negative.
    half = 0.5 * max(ratio, 0.0)
    powers = np.arange(0.5 * (freedom % 2), 0.5 * freedom)
    terms = xlogy(powers, half) - gammaln(powers + 1.0) - half
    if freedom % 2:
        terms = np.append(terms, np.log(2.0) + log_ndtr(-np.sqrt(2.0 * half)))
    # A probability of one may be rounded to more.
    return max(float(-logsumexp(terms) / np.log(10.0)), 0.0)
