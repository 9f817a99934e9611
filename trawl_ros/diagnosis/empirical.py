"""Empirical term of a diagnosis where no effect fits, tested against placebos of all terms.

A placebo is a term whose sign is drawn anew for each window. It has the same size in every window
and goes with nothing, so what the best of all placebos explains is what the best of so many terms
explains by chance.
"""

from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.candidates import candidates, lower_edges, signatures
from trawl_ros.diagnosis.evidence import Evidence, evidence
from trawl_ros.diagnosis.refit import Refit, refitted
from trawl_ros.diagnosis.rules import EMPIRICAL_OVER_PLACEBO, LEAST_BIC
from trawl_ros.diagnosis.score_test import ScoreTest
from trawl_ros.diagnosis.weighing import LeftOver, Weighed, left_over, weigh
from trawl_ros.effects.empirical import EmpiricalTerm, dictionary
from trawl_ros.solver.predict import Predictor

PLACEBOS = 20
REFITTED = 2
"""So many terms are tried, until one leads to a gear with steady states."""


@dataclass(frozen=True)
class Empirical:
    """Empirical term that explains residuals which no effect does.

    Attributes
    ----------
    weighed
        Its refit, and what it explains.
    placebo
        The largest χ² that any term of `PLACEBOS` placebo dictionaries explains.
    left_over
        Residuals beyond their errors after it.
    """

    weighed: Weighed
    placebo: float
    left_over: LeftOver

    @property
    def term(self) -> EmpiricalTerm:
        """The term."""
        return dictionary()[self.weighed.refit.names[0]]


def empirical(predictor: Predictor, base: Refit, test: ScoreTest) -> Empirical | None:
    """Select the best term; None where placebos do nearly as well.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Boards alone.
    test
        Result of the score test.
    """
    depths = lower_edges(base.fit.windows)
    wanted = candidates(dictionary(), predictor, depths)
    columns = signatures(predictor, base.fit.windows, wanted)
    units = np.concatenate([candidate.scale for candidate in wanted])

    def gathered(some: list[FloatArray]) -> Evidence:
        return evidence(test.fit, some, units, weights=test.weights)

    terms = replace(test, wanted=wanted, columns=tuple(columns), evidence=gathered(columns))
    placebo = 0.0
    rng = np.random.default_rng(0)
    for _ in range(PLACEBOS):
        # As many of each: the same sign in all windows would be the term itself.
        signs = rng.permutation(np.resize((1.0, -1.0), len(columns)))
        fake = gathered([sign * own for sign, own in zip(signs, columns, strict=True)])
        placebo = max(placebo, *(fake.chi2([place]) for place in range(len(wanted))))
    ranked = sorted(wanted, key=terms.penalised, reverse=True)
    best = terms.evidence.chi2(terms.block(ranked[0]))
    if best < EMPIRICAL_OVER_PLACEBO * placebo:
        return None
    refits = (refitted(predictor, base, terms, (candidate,)) for candidate in ranked[:REFITTED])
    refit = next(filter(None, refits), None)
    if refit is None:
        return None
    (first,) = weigh(base, terms, [refit])
    if first.delta_bic < LEAST_BIC:
        return None
    return Empirical(first, placebo, left_over(base, terms, first.refit))
