# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Search of a fit in motion: the place of least cost, and the steps that lead there."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.errors import NoSteadyState
from trawl_ros.estimation.fit.estimate import NetFactor
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.least_squares.descent import NO_STEP, Rest
from trawl_ros.estimation.least_squares.linear_problem import LinearProblem, Place
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.information import LinearGroup
from trawl_ros.estimation.motion.nuisances import (
    TowLayout,
    columns,
    linear_part,
    point_of,
)
from trawl_ros.estimation.motion.processes import ErrorSizes, group_rows
from trawl_ros.estimation.motion.sizes import LinearData, estimated_sizes
from trawl_ros.estimation.motion.steps import linear_problem, misfit
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.lineariser import TowLineariser
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.estimation.motion.weights import robust_factors
from trawl_ros.solver.equilibrium import Equilibrium
from trawl_ros.solver.motion.guide import TowGuide
from trawl_ros.solver.motion.parameters import NET

COOLING_FACTOR = 0.4
"""Factor from step to step on the errors of the data while these are taken for too large."""

PREDICTIONS_TO_FIND_ERRORS = 3
"""Predictions after which weights and sizes of the errors are found, before they stay; and so do
stretches that are lost."""

ROUNDED = 1.0 + 1e-9
"""Factor within which costs are alike."""

LOST = 0.15
"""Largest part of the stretches that a step may lose because the model cannot be towed there."""

ROUNDS, STAYS = 4, 0.1
"""Rounds of finding both after a towing; logarithm by which no size changes any more."""

Guides = dict[int, Mapping[float, TowGuide]]
"""Time steps of the moving parts of each tow, by their beginnings (s)."""

OnTow = Callable[[int, int, int], None]


@dataclass
class MotionSearch:
    """Search for the place of least cost: where it is, and the tows as they are there.

    Data much sharper than what is known before would lead a full step to where boards fold. So all
    errors are taken for larger by a factor ``temper`` at first. Weights and ``sizes`` of the errors
    are ``found`` a few times and then stay, or the fit would never converge.
    """

    gear: TowedGear
    tows: Sequence[MovingTow]
    layouts: tuple[TowLayout, ...]
    prior: ParameterVector
    options: MotionOptions
    on_stretch: OnTow
    here: list[FloatArray]
    linear: tuple[LinearisedTow, ...] = ()
    noise: tuple[FloatArray, ...] = ()
    towings: int = 0
    iteration: int = 0
    sizes: ErrorSizes = field(default_factory=ErrorSizes)
    temper: float = np.inf
    found: int = 0
    guides: Guides = field(default_factory=dict)
    last_guides: Guides = field(default_factory=dict)
    last_near: list[Equilibrium] = field(default_factory=list)

    def linearise(
        self, at: Place, iteration: int, before: Sequence[BoolArray] | None = None
    ) -> tuple[LinearisedTow, ...]:
        """Predict all tows at a place, with derivatives.

        Parameters
        ----------
        at
            The place.
        iteration
            Its number.
        before
            Flags of the stretches that were predicted elsewhere; None if any may be lost.

        Raises
        ------
        NoSteadyState
            As soon as more than `LOST` of those before are lost: the rest need not be predicted.
        """
        found: list[LinearisedTow] = []
        spare = 0 if before is None else most_lost(before)
        self.towings += 1
        self.last_near = []
        for number, (tow, layout, z) in enumerate(zip(self.tows, self.layouts, at, strict=True)):
            point = point_of(tow, layout, z, self.prior.start, self.prior.std)
            towed = TowLineariser(
                self.gear, tow.channels, point, partial(self.on_stretch, iteration, number),
                self.guides.get(number, {}),
            )  # fmt: skip
            self.last_guides[number] = towed.guides
            required = None if before is None else before[number]
            towed.extend(tow, point.drifts, required=required, spare=spare)
            self.last_near += towed.equilibria
            found.append(towed.linearised(tow))
            if required is not None:
                spare -= int(np.sum(required & ~found[-1].towed))
        return tuple(found)

    @property
    def is_spent(self) -> bool:
        """True if no further towing may be begun."""
        return self.towings >= self.options.towings

    def begin(self) -> None:
        """Predict all tows where the search begins."""
        self.noise, self.sizes = tuple(tow.noise for tow in self.tows), self.options.sizes
        self.linear = self.linearise(self.here, 0)
        self._keep_near()

    def _keep_near(self) -> None:
        """Keep time steps and equilibria of the last towing, from which the next one starts."""
        self.guides = dict(self.last_guides)
        self.gear = replace(self.gear, near=tuple(self.last_near) or self.gear.near)

    def data(self, linear: Sequence[LinearisedTow], at: Place) -> LinearData:
        """Rows of linearised tows, by the weights as they are."""
        return linear_data(linear, self.layouts, at, self.prior, self.options, self.noise)

    @property
    def is_final(self) -> bool:
        """True if the errors are taken as large as they were found."""
        return self.temper == 1.0

    def problem(self, sizes: ErrorSizes) -> LinearProblem:
        """Linear problem of the tows as they are linearised."""
        data, largest = self.data(self.linear, self.here), self.options.largest_step
        return linear_problem(data, self.here, self.prior, sizes, largest)

    def target(self, sizes: ErrorSizes) -> list[FloatArray]:
        """Place to which the step without damping leads."""
        return self.problem(sizes).target()

    def linearised(self) -> LinearProblem:
        """Return the linear problem here, with weights and sizes of the errors found again."""
        self.iteration += 1
        problem, data = self.problem(self.sizes), self.data(self.linear, self.here)
        self.temper = max(1.0, min(COOLING_FACTOR * self.temper, misfit(data, problem, self.here)))
        if self.is_final and self.found < PREDICTIONS_TO_FIND_ERRORS:
            self.found += 1
            self.sizes = self.find(self.sizes)
        problem = self.problem(self.tempered)
        self.here = problem.projected(self.here, list(map(linear_part, self.layouts)))
        return replace(problem, here=self.here)

    @property
    def tempered(self) -> ErrorSizes:
        """Sizes of the errors as they are taken now."""
        return self.sizes.tempered(self.temper)

    def is_predicted(self, place: Place) -> bool:
        """Return True: a step below the tolerance needs no further prediction."""
        return True

    def fit(self, sizes: ErrorSizes, place: Place, rest: Rest) -> MotionFit:
        """Record of the fit at a place, by the tows as they are linearised."""
        data, prior = self.data(self.linear, self.here), self.prior
        problem = self.problem(sizes)
        every = problem.joined.covariance
        own, layout, known = slice(0, len(prior)), self.layouts[0], self.gear.net_std
        covariance = every[own, own]
        net_std = known * np.sqrt(np.diag(every)[layout.slices['net']])
        return MotionFit(
            values=prior.start + prior.std * place[0][own],
            matrix=problem.joined.matrix,
            covariance=covariance * np.outer(prior.std, prior.std),
            parameters=tuple(place),
            linear=self.linear,
            data=data,
            layouts=self.layouts,
            sizes=sizes,
            readings=sum(len(group.residual) for groups in data.tows for group in groups),
            misfit=misfit(data, problem, place),
            cost=problem.cost(place),
            iterations=rest.iterations,
            converged=rest.converged,
            reason=rest.reason,
            net=tuple(
                NetFactor(what, float(value), float(std), known)
                for what, value, std in zip(NET, layout.net(place[0]), net_std, strict=False)
            ),
        )

    def find(self, sizes: ErrorSizes) -> ErrorSizes:
        """Find weights of the means and sizes of the errors where the step will lead to.

        Nothing is towed for it, so both are found until they stay before the next towing.
        """
        for _ in range(ROUNDS):
            last = sizes
            self.weigh(self.target(sizes), sizes)
            if not self.options.estimate_sizes:
                break
            data = self.data(self.linear, self.here)
            sizes = estimated_sizes(data, self.options.sizes, sizes)
            if sizes.away_from(last) < STAYS:
                break
        return sizes

    def weigh(self, at: Place, sizes: ErrorSizes) -> None:
        """Weigh the means by their residuals at a place."""
        if not np.isfinite(self.options.huber):
            return
        data, found = self.data(self.linear, self.here), []
        parts = zip(self.tows, data.tows, at, self.noise, strict=True)
        for tow, groups, z, weighted in parts:
            noise = weighted.copy()
            for number, group in enumerate(groups):
                rows = group.rows.stretches, group.rows.channels
                noise[rows] = tow.noise[rows] * robust_factors(
                    group, z, sizes.of_group(number), self.options.times, tow.noise[rows],
                    self.options.huber,
                )  # fmt: skip
            found.append(noise)
        self.noise = tuple(found)

    def move(self, place: Place, share: float) -> str:
        """Move to a place if the cost is lower there; return the reason if it is refused.

        Stretches that were lost before count again where they can be predicted, as long as weights
        are found.
        """
        try:
            tried = self.linearise(place, self.iteration, towed_flags(self.linear))
        except NoSteadyState:
            return 'every further step leads to where the model cannot be towed'
        if not self.is_lower(tried, place, self.tempered):
            return NO_STEP
        self.linear = (
            tried if self.found < PREDICTIONS_TO_FIND_ERRORS else without(tried, self.linear)
        )
        self.here = list(place)
        self._keep_near()
        return ''

    def is_lower(
        self,
        tried: Sequence[LinearisedTow],
        there: Place,
        sizes: ErrorSizes,
        free: Sequence[BoolArray] | None = None,
    ) -> bool:
        """True if the `cost` is lower there; stretches that one place lacks belong to neither."""
        before = self.cost(without(self.linear, tried), self.here, sizes, free)
        return self.cost(without(tried, self.linear), there, sizes, free) <= before * ROUNDED

    def cost(
        self,
        linear: Sequence[LinearisedTow],
        place: Place,
        sizes: ErrorSizes,
        free: Sequence[BoolArray] | None = None,
    ) -> float:
        """Cost of the place where tows are linearised.

        Parameters that do not change the linearisation are at their best there (variable
        projection, Golub and Pereyra 1973): shapes of the slowest motions differ from place to
        place, and so does what their amplitudes mean. ``free`` are flags (p,) of others that are.
        """
        data, largest = self.data(linear, place), self.options.largest_step
        problem = linear_problem(data, place, self.prior, sizes, largest)
        free = list(map(linear_part, self.layouts)) if free is None else free
        return problem.cost(problem.projected(place, free))


def towed_flags(linear: Sequence[LinearisedTow]) -> list[BoolArray]:
    """Flags (n,) of the stretches of each tow that are towed along."""
    return [tow.towed for tow in linear]


def count(towed: Sequence[BoolArray]) -> int:
    """Number of stretches that are flagged."""
    return sum(int(np.sum(own)) for own in towed)


def most_lost(before: Sequence[BoolArray]) -> int:
    """Most of the stretches (n,) flagged before that may be lost."""
    return int(LOST * count(before))


def is_lost(towed: Sequence[BoolArray], before: Sequence[BoolArray]) -> bool:
    """True if more than `LOST` of the stretches (n,) flagged before are not towed along."""
    lost = [known & ~own for own, known in zip(towed, before, strict=True)]
    return count(lost) > most_lost(before)


def without(
    tows: Sequence[LinearisedTow], others: Sequence[LinearisedTow]
) -> tuple[LinearisedTow, ...]:
    """Linearised tows without the stretches that others leave out, for the reasons of these."""
    found = []
    for tow, other in zip(tows, others, strict=True):
        values = np.where(other.towed[:, None], tow.values, np.nan)
        told = {part.begin: part for part in (*other.left_out, *tow.left_out)}
        left_out = tuple(part for _, part in sorted(told.items()))
        found.append(replace(tow, values=values, left_out=left_out))
    return tuple(found)


def linear_data(
    linear: Sequence[LinearisedTow],
    layouts: Sequence[TowLayout],
    at: Place,
    prior: ParameterVector,
    options: MotionOptions,
    noise: Sequence[FloatArray],
) -> LinearData:
    """Linearised tows as rows, with residuals of parameters that are all nought."""
    every = []
    for tow, layout, z, own in zip(linear, layouts, at, noise, strict=True):
        slopes = columns(tow, layout, prior.std)
        if not options.nuisances:
            net = layout.slices['net']
            slopes[..., len(prior) : net.start] = slopes[..., net.stop :] = 0.0
        towed = np.where(linear_part(layout), 0.0, z)
        residual = tow.residual + slopes @ towed
        groups = []
        for rows in group_rows(tow.tow, tow.values, own):
            place = rows.stretches, rows.channels
            groups.append(LinearGroup(rows, slopes[place], residual[place]))
        every.append(tuple(groups))
    logs = tuple(layout.of_log for layout in layouts)
    return LinearData(tuple(every), logs, layouts[0].shared, options.times)
