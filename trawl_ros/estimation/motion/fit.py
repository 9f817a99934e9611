"""Levenberg-Marquardt over tows in motion: linearised anew until the estimate is at rest."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.estimation.fit.estimate import NetFactor
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.fit_records import MotionFit, MotionOptions
from trawl_ros.estimation.motion.information import LinearGroup, joined
from trawl_ros.estimation.motion.nuisances import (
    TowLayout,
    columns,
    layout_of,
    linear_part,
    point_of,
)
from trawl_ros.estimation.motion.processes import ErrorSizes, group_rows
from trawl_ros.estimation.motion.sizes import LinearData, estimated_sizes
from trawl_ros.estimation.motion.steps import Place, cost, misfit, shared_std, step
from trawl_ros.estimation.motion.towing.linearised_tow import LinearisedTow
from trawl_ros.estimation.motion.towing.lineariser import linearise_tow
from trawl_ros.estimation.motion.towing.records import MovingTow
from trawl_ros.estimation.motion.towing.towed_gear import TowedGear
from trawl_ros.estimation.motion.weights import robust_factors
from trawl_ros.solver.motion.parameters import NET

NEAR = 0.3
"""Part of every std, as it will be stated, from which a fit is at rest where its step lowers no
cost."""

COOLER = 0.4
"""Factor from step to step on the errors of the data while these are taken for too large."""

DAMPING, STIFFER, LOOSER = 1.0, 30.0, 0.2
"""First damping after a step that was refused, factors after each further one and after one that
was taken."""

LEAST_DAMPING = 0.1
"""Damping below this is none."""

LOST = 0.4
"""Part of the stretches that a step may lose, where the motion of the model cannot be computed. A
single fall of a board costs fourteen, 13 % of an hour: who refuses that stays where boards fall."""

FINDINGS = 3
"""Towings after which weights and sizes of the errors are found, before they stay."""

ROUNDS, STAYS = 4, 0.1
"""Rounds of finding both after a towing; logarithm by which no size changes any more."""

OnTow = Callable[[int, int, int], None]


@dataclass
class MotionSearch:
    """Search for the place of least cost: where it is, and the tows as they are there."""

    gear: TowedGear
    tows: Sequence[MovingTow]
    layouts: tuple[TowLayout, ...]
    prior: ParameterVector
    options: MotionOptions
    on_stretch: OnTow
    here: list[FloatArray]
    linear: tuple[LinearisedTow, ...] = ()
    noise: tuple[FloatArray, ...] = ()
    damping: float = 0.0
    towings: int = 0

    def linearise(self, at: Place, iteration: int) -> tuple[LinearisedTow, ...]:
        """Tow all tows at a place, and linearise."""
        found = []
        self.towings += 1
        for number, (tow, layout, z) in enumerate(zip(self.tows, self.layouts, at, strict=True)):
            point = point_of(tow, layout, z, self.prior.start, self.prior.std)
            then = partial(self.on_stretch, iteration, number)
            found.append(linearise_tow(self.gear, tow, point, on_stretch=then))
        return tuple(found)

    def data(self, linear: Sequence[LinearisedTow], at: Place) -> LinearData:
        """Rows of linearised tows, by the weights as they are."""
        return linear_data(linear, self.layouts, at, self.prior, self.options, self.noise)

    def target(self, sizes: ErrorSizes) -> list[FloatArray]:
        """Place to which the step without damping leads."""
        data = self.data(self.linear, self.here)
        return step(data, self.here, self.prior, sizes, self.options.largest_step)

    def fit(
        self, sizes: ErrorSizes, place: Place, iterations: int, *, converged: bool, reason: str
    ) -> MotionFit:
        """Record of the fit at a place, by the tows as they are linearised."""
        data, prior = self.data(self.linear, self.here), self.prior
        told = joined(data.information(sizes), data.precisions(sizes.log), data.shared)
        every = np.linalg.inv(told.matrix + np.eye(data.shared))
        covariance, layout, known = every[:12, :12], self.layouts[0], self.gear.net_std
        std = known * np.sqrt(np.diag(every)[layout.of_net])
        return MotionFit(
            values=prior.start + prior.std * place[0][:12],
            matrix=told.matrix,
            covariance=covariance * np.outer(prior.std, prior.std),
            parameters=tuple(place),
            linear=self.linear,
            data=data,
            layouts=self.layouts,
            sizes=sizes,
            readings=sum(len(group.residual) for groups in data.tows for group in groups),
            misfit=misfit(data, place, sizes),
            cost=cost(data, place, sizes),
            iterations=iterations,
            converged=converged,
            reason=reason,
            net=tuple(
                NetFactor(what, float(value), float(own), known)
                for what, value, own in zip(NET, layout.net(place[0]), std, strict=False)
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

    def advance(self, sizes: ErrorSizes, iteration: int, attempts: int) -> bool:
        """Take a step that lowers the cost, ever shorter; tell whether one was found."""
        data = self.data(self.linear, self.here)
        towed = [tow.towed for tow in self.linear]
        for _ in range(attempts):
            there = step(
                data, self.here, self.prior, sizes, self.options.largest_step, self.damping
            )
            tried = self.linearise(there, iteration)
            both = [old & new.towed for old, new in zip(towed, tried, strict=True)]
            lost = sum(int(np.sum(old)) for old in towed) - sum(int(np.sum(b)) for b in both)
            if lost <= LOST * sum(int(np.sum(old)) for old in towed):
                # Stretches that can be towed at one place alone belong to neither cost.
                before, after = (
                    cost(
                        self.data([only(*each) for each in zip(tows, both, strict=True)], z),
                        z,
                        sizes,
                    )
                    for tows, z in ((self.linear, self.here), (tried, there))
                )
                if after <= before * (1.0 + 1e-9):
                    self.here, self.linear = there, tried
                    self.damping *= LOOSER
                    if self.damping < LEAST_DAMPING:
                        self.damping = 0.0
                    return True
            self.damping = max(DAMPING, STIFFER * self.damping)
        return False


def fit_motion(
    gear: TowedGear,
    tows: Sequence[MovingTow],
    prior: ParameterVector,
    options: MotionOptions,
    start: Place | None = None,
    on_stretch: OnTow = lambda iteration, tow, stretch: None,
) -> MotionFit:
    """Fit tows in motion.

    Parameters
    ----------
    gear, tows
        The gear that is towed, and its records.
    prior
        Of the twelve coefficients.
    options
        Of the fit.
    start
        Parameters of each tow to begin with, in prior std; all nought where None.
    on_stretch
        Called with the numbers of iteration, tow and stretch.
    """
    layouts = tuple(layout_of(tow, gear, options.model) for tow in tows)
    here = [np.zeros(len(layout)) for layout in layouts] if start is None else list(start)
    search = MotionSearch(gear, tows, layouts, prior, options, on_stretch, here)
    search.noise = tuple(tow.noise for tow in tows)
    search.linear = search.linearise(here, 0)
    sizes = options.sizes
    reason = f'still moving after {options.iterations} iterations'
    converged, iteration, temper, found = False, 0, np.inf, 0
    for iteration in range(1, options.iterations + 1):
        data = search.data(search.linear, search.here)
        # Data much sharper than what is known before would lead a full step to where boards fold.
        temper = max(1.0, min(COOLER * temper, misfit(data, search.here, sizes)))
        # Weights and sizes that are found anew for ever would keep a fit from its rest.
        if temper == 1.0 and found < FINDINGS:
            found += 1
            sizes = search.find(sizes)
            data = search.data(search.linear, search.here)
        now = sizes.tempered(temper)
        target = step(data, search.here, prior, now, options.largest_step)
        std = shared_std(data, now)[:12]
        size = float(np.max(np.abs(target[0][:12] - search.here[0][:12]) / std))
        if temper == 1.0 and size < options.tolerance:
            converged = True
            reason = (
                f'after {iteration} iterations the step is below {options.tolerance:g} of every std'
            )
            break
        if search.towings >= options.towings:
            reason = f'still moving after {search.towings} towings'
            break
        near = temper == 1.0 and size < NEAR
        if not search.advance(now, iteration, 1 if near else options.attempts) and temper == 1.0:
            converged = near
            reason = f'no step lowers the cost, {size:.2g} std from rest'
            break
    place = search.target(sizes) if converged else search.here
    return search.fit(sizes, place, iteration, converged=converged, reason=reason)


def only(tow: LinearisedTow, flags: BoolArray) -> LinearisedTow:
    """Linearised tow with the flagged (n,) stretches alone."""
    return replace(tow, values=np.where(flags[:, None], tow.values, np.nan))


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
            slopes[..., len(prior) : layout.of_net.start] = slopes[..., layout.of_gear :] = 0.0
        towed = z * (1.0 - linear_part(layout))
        residual = tow.residual + slopes @ towed
        groups = []
        for rows in group_rows(tow.tow, tow.values, own):
            place = rows.stretches, rows.channels
            groups.append(LinearGroup(rows, slopes[place], residual[place]))
        every.append(tuple(groups))
    logs = tuple(layout.of_log for layout in layouts)
    return LinearData(tuple(every), logs, layouts[0].shared, options.times)
