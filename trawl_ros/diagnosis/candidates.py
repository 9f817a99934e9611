"""Candidate effects, their start values, and their signatures in the windows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from trawl_ros.effects.base.effect import Effect
from trawl_ros.effects.effect_set import ActiveEffect
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.fit import AS_STATED, Fit
from trawl_ros.estimation.fit.linearised import Linearised
from trawl_ros.estimation.fit.prior import BoardPrior
from trawl_ros.records.coefficients import COEFFICIENTS
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.solver.predict import Predictor

WIDE = 5.0
"""So many times further than is common an effect is taken to go where it is estimated."""


@dataclass(frozen=True)
class Candidate:
    """Candidate effect with its start values (m,).

    ``place`` counts the starts of an effect that is searched from several.
    """

    effect: Effect
    start: np.ndarray
    place: int = 0

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.name

    @property
    def scale(self) -> np.ndarray:
        """Prior std of the values (m,) about neutral."""
        return np.array([parameter.std for parameter in self.effect.parameters])

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bounds of the values (m,)."""
        low, high = zip(*((p.low, p.high) for p in self.effect.parameters), strict=True)
        return np.array(low), np.array(high)


def candidates(
    effects: Mapping[str, Effect], predictor: Predictor, depths: np.ndarray
) -> tuple[Candidate, ...]:
    """All candidates that steady tows may show.

    Parameters
    ----------
    effects
        The catalogue.
    predictor
        The gear; an effect that it has already is looked for around the values it has.
    depths
        Of the net in the tows at hand (n,), m.
    """
    found = []
    for effect in effects.values():
        if effect.dynamic:
            continue
        there = predictor.fixed.of(effect)
        starts = effect.starts(depths)
        if any(active.name == effect.name for active in predictor.fixed.effects):
            starts = (there.values,)
        found += [Candidate(effect, start, place) for place, start in enumerate(starts)]
    return tuple(found)


def blocks_of_candidates(wanted: Sequence[Candidate]) -> tuple[range, ...]:
    """Slices of the candidates' values in their joint vector."""
    ends = np.cumsum([len(candidate.start) for candidate in wanted]).tolist()
    return tuple(range(a, b) for a, b in pairwise([0, *ends]))


def signatures(
    predictor: Predictor, parts: Sequence[Linearised], wanted: Sequence[Candidate]
) -> list[np.ndarray]:
    """Signatures of the candidates: changes in the windows' readings per unit of their values.

    Returns
    -------
    list
        For each window an array (channels of the window, values of all candidates) per unit of the
        value; 0 in tows without.
    """
    active = [ActiveEffect(candidate.effect, candidate.start) for candidate in wanted]
    number = sum(len(one.values) for one in active)
    found = []
    for part in parts:
        there = predictor.situated(part.window)
        rows = [OBSERVABLES.index(name) for name in part.channels]
        if there.absent or not active:
            found.append(np.zeros((len(rows), number)))
            continue
        board = part.at[: len(COEFFICIENTS)]
        found.append(there.signatures(board, part.inputs, part.state, active)[rows])
    return found


def extended(
    fit: Fit, wanted: Sequence[Candidate], columns: Sequence[np.ndarray], options: EstimatorOptions
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
    board = slice(len(COEFFICIENTS))
    starts = np.concatenate([candidate.start for candidate in wanted])
    parts = tuple(
        replace(part, at=part.at[board], by_coefficients=part.by_coefficients[:, board])
        for part in fit.windows
    )
    return Fit(
        behind(parts, starts, columns),
        np.concatenate((fit.coefficients[board], starts)),
        AS_STATED,
        extended_prior(fit.prior, wanted),
        options,
    )


def behind(
    parts: Sequence[Linearised], values: np.ndarray, columns: Sequence[np.ndarray]
) -> tuple[Linearised, ...]:
    """Windows with more values (m,) appended to all others.

    With what each of these changes: for each window (channels of the window, m).
    """
    return tuple(
        replace(
            part,
            at=np.concatenate((part.at, values)),
            by_coefficients=np.hstack((part.by_coefficients, own)),
        )
        for part, own in zip(parts, columns, strict=True)
    )


def extended_prior(prior: BoardPrior, wanted: Sequence[Candidate]) -> BoardPrior:
    """Joint prior of the boards, and of effects that may or may not be present."""
    lows, highs = zip(*(candidate.bounds for candidate in wanted), strict=True)
    effects = BoardPrior(
        start=np.concatenate([candidate.start for candidate in wanted]),
        std=np.concatenate([WIDE * candidate.scale for candidate in wanted]),
        low=np.concatenate(lows),
        high=np.concatenate(highs),
        names=tuple(
            f'{candidate.name} {parameter.name}'
            for candidate in wanted
            for parameter in candidate.effect.parameters
        ),
    )
    return prior.first(len(COEFFICIENTS)).followed_by(effects)
