# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Candidate effects, their start values, and their signatures in the windows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import WIDE, Effect
from trawl_ros.effects.effect_set import ActiveEffect
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.parameters import ParameterGroup, ParameterVector
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

SIDES = ('port', 'starboard')


@dataclass(frozen=True)
class Candidate:
    """Candidate effect with its start values (m,).

    ``place`` counts the starts of an effect that is searched from several.
    """

    effect: Effect
    start: FloatArray
    place: int = 0

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.name

    @property
    def scale(self) -> FloatArray:
        """Prior std of the values (m,) about neutral."""
        return np.array([parameter.std for parameter in self.effect.parameters])

    @property
    def group(self) -> ParameterGroup:
        """The values as parameters of a fit."""
        own = self.effect.parameters
        return ParameterGroup(
            'effect',
            tuple(f'{self.name} {parameter.name}' for parameter in own),
            tuple(parameter.unit for parameter in own),
        )


def lower_edges(linearised: Sequence[Linearised]) -> FloatArray:
    """Depths (n,), m, of the lower edge of the net's mouth.

    Where no sensor measures the opening it is the median of the others, none where none does; the
    doors stand for a headline without a depth.
    """
    means = [linear.window.means for linear in linearised]
    doors = [[own.get(f'{side}_door_depth', np.nan) for side in SIDES] for own in means]
    depths, heights = (
        np.array([own.get(name, np.nan) for own in means])
        for name in ('net_depth', 'vertical_opening')
    )
    depths = np.where(np.isfinite(depths), depths, np.mean(doors, axis=1))
    known = heights[np.isfinite(heights)]
    usual = float(np.median(known)) if len(known) else 0.0
    lowest: FloatArray = depths + np.where(np.isfinite(heights), heights, usual)
    lowest = lowest[np.isfinite(lowest)]
    return lowest if len(lowest) else np.zeros(1)


def values_vector(wanted: Sequence[Candidate]) -> ParameterVector:
    """Vector of the candidates' values, which may or may not be present: one group for each."""
    own = [parameter for candidate in wanted for parameter in candidate.effect.parameters]
    return ParameterVector(
        start=np.array([value for candidate in wanted for value in candidate.start]),
        std=WIDE * np.array([parameter.std for parameter in own]),
        low=np.array([parameter.low for parameter in own]),
        high=np.array([parameter.high for parameter in own]),
        groups=tuple(candidate.group for candidate in wanted),
    )


def signatures(
    predictor: Predictor, linearised: Sequence[Linearised], wanted: Sequence[Candidate]
) -> list[FloatArray]:
    """Signatures of the candidates: changes in the windows' readings per unit of their values.

    Returns
    -------
    list
        For each window an array (channels of the window, values of all candidates) per unit of the
        value; 0 in tows without.
    """
    active = [ActiveEffect(candidate.effect, candidate.start) for candidate in wanted]
    number = sum(len(effect.values) for effect in active)
    by_window = []
    for linear in linearised:
        situated = predictor.situated(linear.window)
        rows = [OBSERVABLES.index(name) for name in linear.channels]
        if situated.absent or not active:
            by_window.append(np.zeros((len(rows), number)))
            continue
        board = linear.at[: len(predictor.model.coefficients)]
        by_window.append(situated.signatures(board, linear.inputs, linear.state, active)[rows])
    return by_window


def extended(
    fit: Fit, wanted: Sequence[Candidate], columns: Sequence[FloatArray], options: EstimatorOptions
) -> Fit:
    """Fit with the candidates' values appended to the coefficients.

    Parameters
    ----------
    fit
        Of the boards alone.
    wanted, columns
        The candidates, and what they change in each of its windows, from `signatures`.
    options
        Of the estimate.
    """
    board = fit.prior.slice_of('coefficients')
    starts = np.concatenate([candidate.start for candidate in wanted])
    windows = tuple(
        linear.only(board).followed_by(starts, own)
        for linear, own in zip(fit.windows, columns, strict=True)
    )
    return Fit(
        windows,
        np.concatenate((fit.coefficients[board], starts)),
        AS_STATED,
        with_candidates(fit.prior, wanted),
        options,
    )


def with_candidates(prior: ParameterVector, wanted: Sequence[Candidate]) -> ParameterVector:
    """Vector of the boards alone, with the candidates' values behind them."""
    return prior.only('coefficients').followed_by(values_vector(wanted))
