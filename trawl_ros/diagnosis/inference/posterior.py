# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Posterior over sets of hypotheses: first order for all, refitted for those that matter."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product

import numpy as np
from scipy.special import logsumexp

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.diagnosis.inference.blocks import blocks_of, form_errors
from trawl_ros.diagnosis.inference.marginal import Marginal, marginal
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.diagnosis.inference.refit import Refit, refitted, told
from trawl_ros.diagnosis.inference.screen import Screen, Suspect, names_of, ready_for
from trawl_ros.diagnosis.inference.unknown import Unknown, unknown
from trawl_ros.diagnosis.inference.variants import Chosen, log_factor
from trawl_ros.solver.predict import Predictor

Key = tuple[int, ...]
"""Places of suspects, rising."""


@dataclass(frozen=True)
class Explanation:
    """Set of causes, none for the boards alone.

    Attributes
    ----------
    suspects
        The causes of the library.
    log_factor
        Log Bayes factor over the boards alone.
    log_odds
        Prior odds of all causes, logarithm.
    refit
        Refit of boards and causes, where there is one.
    unknown
        Patterns of something else that is there too.
    probability
        Posterior probability.
    """

    suspects: tuple[Suspect, ...]
    log_factor: float
    log_odds: float
    refit: Refit | None = None
    unknown: Unknown | None = None
    probability: float = 0.0

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the causes of the library."""
        return names_of(self.suspects)


@dataclass(frozen=True)
class Posterior:
    """Posterior: explanations, the likeliest first."""

    explanations: tuple[Explanation, ...]

    @property
    def nothing(self) -> float:
        """Probability that the boards alone explain the readings."""
        return sum(
            own.probability for own in self.explanations if not own.suspects and not own.unknown
        )

    @property
    def unknown(self) -> float:
        """Probability that something is there which the library does not have."""
        return sum(own.probability for own in self.explanations if own.unknown)

    @property
    def leaves(self) -> Mapping[str, float]:
        """Probability that each cause is there, by name, the likeliest first."""
        found: dict[str, float] = {}
        for own in self.explanations:
            for name in dict.fromkeys(own.names):
                found[name] = found.get(name, 0.0) + own.probability
        return dict(sorted(found.items(), key=lambda pair: -pair[1]))

    @property
    def nodes(self) -> Mapping[str, float]:
        """Probability that any cause of each node is there, by path, the likeliest first."""
        found: dict[str, float] = {}
        for own in self.explanations:
            paths = {path for suspect in own.suspects for path in above(suspect.entry.node.path)}
            for path in paths:
                found[path] = found.get(path, 0.0) + own.probability
        return dict(sorted(found.items(), key=lambda pair: (-pair[1], -len(pair[0]))))

    @property
    def best(self) -> Explanation | None:
        """Likeliest explanation with a cause of the library that was refitted."""
        return next((own for own in self.explanations if own.refit is not None), None)

    def entry(self, name: str) -> Suspect:
        """Return the likeliest suspect of a name."""
        return next(
            suspect
            for own in self.explanations
            for suspect in own.suspects
            if suspect.entry.name == name
        )


def above(path: str) -> Iterator[str]:
    """Yield a path and those of the nodes above it."""
    parts = path.split('/')
    for number in range(len(parts), 0, -1):
        yield '/'.join(parts[:number])


@dataclass
class _Search:
    """Search for the posterior.

    Attributes
    ----------
    factors, first
        Log Bayes factors of sets, as known now and to first order.
    nearest
        Refitted set around which a set is known to first order; none: the boards alone.
    refits, around
        Refits of sets, and the marginals around them.
    """

    predictor: Predictor
    base: Refit
    screen: Screen
    options: InferenceOptions
    on_progress: OnProgress
    factors: dict[Key, float] = field(default_factory=dict)
    first: dict[Key, float] = field(default_factory=dict)
    nearest: dict[Key, Key] = field(default_factory=dict)
    refits: dict[Key, Refit | None] = field(default_factory=dict)
    around: dict[Key, Marginal] = field(default_factory=dict)

    def chosen(self, key: Key) -> Chosen:
        """Return the likeliest variants of a set, to first order, one cause after another."""
        best, found = Chosen(), self.screen.marginal
        for place in key:
            block = self.screen.suspects[place].block
            one = max(
                self.screen.suspects[place].variants,
                key=lambda own: log_factor(found, Chosen().joined(block, own)),
            )
            best = best.joined(block, one)
            alone = Chosen().joined(block, one)
            found = found.given(alone.places, alone.mean, alone.std)
        return best

    def grow(self, keys: Sequence[Key]) -> list[Key]:
        """Add every hypothesis to sets, to first order; return the new sets."""
        grown = []
        for key in keys:
            first = self.factors[key]
            beside, offset = self._beside(key)
            taken = {self.screen.suspects[place].candidate.name for place in key}
            for place, suspect in enumerate(self.screen.suspects):
                new = tuple(sorted((*key, place)))
                if suspect.candidate.name in taken:
                    continue
                block = moved(suspect.block, offset)
                each = [
                    log_factor(beside, Chosen().joined(block, variant))
                    for variant in suspect.variants
                ]
                factor = first + float(logsumexp(each))
                if not self.is_worth(new, factor):
                    continue
                if factor > self.factors.get(new, -np.inf):
                    self.factors[new] = factor
                    self.nearest[new] = key if key in self.around else self.nearest.get(key, ())
                    grown.append(new)
        return sorted(set(grown), key=self.weight, reverse=True)

    def _beside(self, key: Key) -> tuple[Marginal, int]:
        """Return the marginal with a set integrated out, around the nearest refit.

        With it goes the place where the values of all hypotheses begin.
        """
        near = key if key in self.around else self.nearest.get(key, ())
        found, offset = self.screen.marginal, 0
        if near:
            best = self._likeliest(near)
            found = self.around[near].given(best.places, best.mean, best.std)
            offset = sum(len(self.screen.suspects[place].block) for place in near)
        for place in (own for own in key if own not in near):
            block = moved(self.screen.suspects[place].block, offset)
            one = max(
                (Chosen().joined(block, own) for own in self.screen.suspects[place].variants),
                key=lambda chosen: log_factor(found, chosen),
            )
            found = found.given(one.places, one.mean, one.std)
        return found, offset

    def _likeliest(self, key: Key) -> Chosen:
        """Return the likeliest variants of a refitted set."""
        suspects = tuple(self.screen.suspects[place] for place in key)
        return max(_choices(suspects), key=lambda chosen: log_factor(self.around[key], chosen))

    def is_worth(self, new: Key, factor: float) -> bool:
        """True if a set of several is likelier than each part (Madigan and Raftery 1994)."""
        parts = (part for size in range(1, len(new)) for part in combinations(new, size))
        weight = self.odds(new) + factor / self.options.temperature
        return all(weight > self.weight(part) for part in parts if part in self.factors)

    def known(self, key: Key) -> float:
        """Log Bayes factor of the refitted set around which a set is known to first order."""
        return self.factors[self.nearest.get(key, ())]

    def weight(self, key: Key) -> float:
        """Log of the posterior weight of a set."""
        return self.odds(key) + self.factors[key] / self.options.temperature

    def odds(self, key: Key) -> float:
        """Log of the prior odds of a set."""
        return sum(self.screen.suspects[place].log_odds for place in key)

    def refit_likely(self, keys: Sequence[Key]) -> None:
        """Refit those of some sets that are likelier than nothing."""
        for key in keys:
            if self.weight(key) > 0.0:
                self._refit(key)

    def refit_parts(self) -> bool:
        """Refit the sets that lack one cause of the likeliest one; False where all are."""
        likely = max((key for key in self.around if key), key=self.weight, default=())
        parts = [tuple(own for own in likely if own != out) for out in likely]
        waiting = [key for key in parts if key and key not in self.refits]
        for key in waiting:
            self.factors.setdefault(key, -np.inf)
            self._refit(key)
        return bool(waiting)

    def refit_next(self) -> bool:
        """Refit the likeliest set that is not refitted; False where enough are."""
        waiting = [key for key in self.factors if key and key not in self.refits]
        if not waiting or len(self.refits) >= self.options.refits:
            return False
        # What first order missed of one cause it may miss of another that explains as much.
        missed = max(
            (
                (self.factors[key] - first) / gain
                for key, first in self.first.items()
                if (gain := first - self.known(key)) > 0.0
            ),
            default=0.0,
        )
        hoped = {
            key: self.weight(key)
            + max(missed, 0.0)
            * max(self.factors[key] - self.known(key), 0.0)
            / self.options.temperature
            for key in waiting
        }
        key = max(waiting, key=lambda own: hoped[own])
        every = logsumexp([hoped.get(own, self.weight(own)) for own in self.factors])
        if logsumexp(list(hoped.values())) - every < np.log(self.options.tail):
            return False
        if hoped[key] - every < np.log(self.options.least_share):
            return False
        self._refit(key)
        return True

    def _refit(self, key: Key) -> None:
        """Refit a set, and take its evidence from there."""
        suspects = tuple(self.screen.suspects[place] for place in key)
        self.on_progress(told(*names_of(suspects)))
        fitted = self._refitted(key, suspects)
        self.refits[key], self.first[key] = fitted, self.factors[key]
        if fitted is None:
            self.factors[key] = -np.inf
        else:
            self.around[key] = self._around(fitted, suspects)
            self.factors[key] = self._factor(self.around[key], suspects)

    def _refitted(self, key: Key, suspects: tuple[Suspect, ...]) -> Refit | None:
        chosen = self.chosen(key)
        _, mean, _ = self.screen.marginal.posterior(chosen.places, chosen.mean, chosen.std)
        away = np.zeros(self.screen.number)
        away[list(chosen.places)] = mean
        places = [place for suspect in suspects for place in suspect.block]
        wanted = tuple(suspect.candidate for suspect in suspects)
        predictor = ready_for(self.predictor, [one.effect for one in wanted])
        columns = [own[:, places] for own in self.screen.columns]
        return refitted(predictor, self.base, wanted, columns, away[places])

    def _around(self, fitted: Refit, suspects: tuple[Suspect, ...]) -> Marginal:
        """Marginal around a refit.

        It is of values of the suspects, behind them those of all hypotheses, and sizes of patterns.
        """
        screen, fit = self.screen, self.screen.counted(fitted.fit)
        effects = fit.prior.slice_of('effect')
        scale = np.concatenate([suspect.candidate.scale for suspect in suspects])
        starts = np.concatenate([suspect.candidate.start for suspect in suspects])
        away = (fitted.values - starts) / scale
        own = [linear.by_coefficients[:, effects] * scale for linear in fit.windows]
        form = form_errors(fit, [columns @ away for columns in own], screen.errors.form)
        units = np.concatenate([suspect.candidate.scale for suspect in screen.suspects])
        columns = [
            np.hstack((fitted, every * units, shapes))
            for fitted, every, shapes in zip(own, screen.columns, screen.shapes, strict=True)
        ]
        others = np.zeros(screen.number + len(screen.patterns))
        blocks = blocks_of(
            fit, columns, errors=screen.errors, weights=screen.weights, form=form,
            away=np.concatenate((away, others)),
        )  # fmt: skip
        return marginal(blocks)

    def _factor(self, around: Marginal, suspects: tuple[Suspect, ...]) -> float:
        each = [log_factor(around, chosen) for chosen in _choices(suspects)]
        return float(logsumexp(each)) + around.log_evidence - self.screen.marginal.log_evidence

    def beside(self, key: Key) -> tuple[float, Unknown]:
        """Return the log Bayes factor of a set with H? beside it, and H?."""
        if not key:
            screen = self.screen
            places = range(screen.number, screen.number + len(screen.patterns))
            found = unknown(screen.marginal.of(places), self.options)
            return found.log_factor, found
        beside, _ = self._beside(key)
        number = len(self.screen.patterns)
        places = range(len(beside.score) - number, len(beside.score))
        found = unknown(beside.of(places), self.options)
        return self.factors[key] + found.log_factor, found


def moved(block: range, offset: int) -> range:
    """Return a block of places behind an offset."""
    return range(block.start + offset, block.stop + offset)


def _choices(suspects: tuple[Suspect, ...]) -> Iterator[Chosen]:
    """Yield all choices of a variant for each of some suspects, whose values stand together."""
    blocks, first = [], 0
    for suspect in suspects:
        blocks.append(range(first, first + len(suspect.block)))
        first = blocks[-1].stop
    for variants in product(*(suspect.variants for suspect in suspects)):
        chosen = Chosen()
        for block, variant in zip(blocks, variants, strict=True):
            chosen = chosen.joined(block, variant)
        yield chosen


def infer(
    predictor: Predictor,
    base: Refit,
    screen: Screen,
    options: InferenceOptions,
    on_progress: OnProgress = ignore,
) -> Posterior:
    """Find the posterior over sets of hypotheses.

    Parameters
    ----------
    predictor
        The gear as it is believed.
    base
        Fit of the boards alone.
    screen
        All hypotheses to first order.
    options
        Options of the inference.
    on_progress
        Called before each refit.
    """
    search = _Search(predictor, base, screen, options, on_progress, factors={(): 0.0})
    keys = search.grow([()])
    # Refitted before they grow: what first order misses of one cause, others would make up.
    search.refit_likely(keys[: options.grown])
    keys = sorted(search.around or keys, key=search.weight, reverse=True)
    for _ in range(1, options.largest_set):
        keys = search.grow(keys[: options.grown])
    while search.refit_next() or search.refit_parts():
        pass
    found = [
        Explanation(
            tuple(screen.suspects[place] for place in key),
            factor,
            sum(screen.suspects[place].log_odds for place in key),
            search.refits.get(key),
        )
        for key, factor in search.factors.items()
        if np.isfinite(factor)
    ]
    likely = sorted((key for key in search.around), key=search.weight, reverse=True)
    odds = float(np.log(options.unknown_rate / (1.0 - options.unknown_rate)))
    for key in [(), *likely[: options.sets_with_unknown]]:
        factor, patterns = search.beside(key)
        found.append(
            Explanation(
                tuple(screen.suspects[place] for place in key),
                factor,
                odds + sum(screen.suspects[place].log_odds for place in key),
                search.refits.get(key),
                patterns,
            )
        )
    return Posterior(weighted(found, options.temperature))


def weighted(found: Sequence[Explanation], temperature: float) -> tuple[Explanation, ...]:
    """Return explanations with their probabilities, the likeliest first."""
    weights = np.array([own.log_odds + own.log_factor / temperature for own in found])
    shares: FloatArray = np.exp(weights - logsumexp(weights))
    whole = [
        replace(own, probability=float(share)) for own, share in zip(found, shares, strict=True)
    ]
    return tuple(sorted(whole, key=lambda own: -own.probability))
