# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Limits of knowledge after a trial: reasons why a quantity stays badly known."""

from collections.abc import Mapping, Sequence
from itertools import chain

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.estimation.fit.laws import LAWS, QUANTITIES, LawQuantities, law_rows
from trawl_ros.estimation.planning.information import covariance_from, unknowns
from trawl_ros.estimation.planning.search import Designer
from trawl_ros.estimation.planning.states import Manoeuvre

WITHOUT_END = 1e4
"""Each leg so many times over: what noise is left hides nothing any more."""


def limits_of(
    designer: Designer, manoeuvres: Sequence[Manoeuvre], known: LawQuantities
) -> Mapping[str, str]:
    """Return the reason for each quantity that is not well known after a trial.

    ``noise`` where the same legs without end would do, ``calibration`` where instruments without
    bias would, ``model`` where a model without error would, several where all of these together
    would, and else the coefficient of another law with which it is confounded most.

    Parameters
    ----------
    designer
        Of the trial.
    manoeuvres
        The trial.
    known
        Quantities of the laws after it.
    """
    once, often = (designer.information(manoeuvres, times) for times in (1.0, WITHOUT_END))
    among = unknowns(designer.problem.prior, designer.problem.estimator)
    every = set(range(len(among)))
    calibration, model = ({*chain(*among.blocks(kind))} for kind in ('calibration', 'model'))
    remedies = (
        ('noise', often, every),
        ('calibration', once, every - calibration),
        ('model', once, every - model),
        ('noise and calibration', often, every - calibration),
        ('noise, calibration and model', often, every - calibration - model),
    )
    remedy: dict[str, str] = {}
    for name, information, kept in remedies:
        chosen = sorted(kept)
        covariance = covariance_from(information[np.ix_(chosen, chosen)], designer.problem.prior)
        helped = designer.problem.quantities(covariance).well_known
        for quantity, before, after in zip(QUANTITIES, known.well_known, helped, strict=True):
            if after and not before:
                remedy.setdefault(quantity, name)
    covariance = designer.covariance(manoeuvres)
    for index, quantity in enumerate(QUANTITIES):
        if not known.well_known[index] and quantity not in remedy:
            remedy[quantity] = f'confounded with {_partner(designer, covariance, index)}'
    return {quantity: remedy[quantity] for quantity in QUANTITIES if quantity in remedy}


def _partner(designer: Designer, covariance: FloatArray, index: int) -> str:
    """Name the coefficient of another law whose knowledge would improve a quantity most."""
    problem, number = designer.problem, len(LAWS)
    rows = law_rows(problem.law, problem.coefficients, problem.angles)
    shared = (covariance @ rows[index]) ** 2 / np.diag(covariance)
    shared[(rows[index % number :: number] != 0.0).any(axis=0)] = 0.0
    return problem.prior.names[int(np.argmax(shared))]
