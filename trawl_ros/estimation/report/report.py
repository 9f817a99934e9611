# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Report of an identification, computed once for JSON, figures and page."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray, IntArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, ignore
from trawl_ros.estimation.fit.estimate import Estimate
from trawl_ros.estimation.fit.estimator import Progress
from trawl_ros.estimation.fit.laws import (
    LawQuantities,
    WorkingAngles,
    law_quantities,
    law_spans,
    working_angles,
)
from trawl_ros.estimation.fit.linearised import Linearised, paper_rows
from trawl_ros.estimation.fit.objective import mnae, objective, paper_values, stack
from trawl_ros.estimation.fit.parameters import ParameterVector
from trawl_ros.estimation.motion.holdout import HeldOut
from trawl_ros.estimation.motion.outcome import MotionOutcome
from trawl_ros.estimation.pipeline import Identification, WindowUsed
from trawl_ros.estimation.report.holdout import hold_out
from trawl_ros.estimation.report.residuals import (
    ChannelResiduals,
    innovations,
    residuals,
)
from trawl_ros.estimation.report.sensors import SensorComparison, compare_sensors
from trawl_ros.estimation.report.spectrum import Spectrum, spectrum
from trawl_ros.estimation.windows.records import REASONS, Rejections, SteadyWindow
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.board_laws import BoardLaw
from trawl_ros.model.gear_model import build_board
from trawl_ros.records.channels import INPUTS


@dataclass(frozen=True)
class TowOutcome:
    """Outcome of a tow.

    Known are its number, name, counts of windows and steady states, and the errors (4,) in the
    channels of eq. 35 with which they were predicted when ``held_out``.
    """

    tow: int
    name: str
    windows: int
    states: int
    held_out: FloatArray


@dataclass(frozen=True)
class KnownLaws:
    """Laws of the boards at their working angles.

    ``attack`` has the least and largest mean α (rad) of both boards in the windows' states,
    ``angles`` the means over them, and ``quantities`` values and slopes there.
    """

    attack: tuple[float, float]
    angles: WorkingAngles
    quantities: LawQuantities


@dataclass(frozen=True)
class Report:
    """Report of an identification with its data.

    Attributes
    ----------
    estimate
        Estimate of the coefficients.
    prior_weight
        1 where the prior was used, 0 where the data alone decided.
    truth : (q,) array or None
        The coefficients that made the data, where they are known.
    rejected, found
        Reason → count, and → what was found last.
    windows
        The steady windows in the fit, n of them.
    tows
        The name of each tow that a window can belong to.
    measured, at_start, at_end : (n, 4) arrays
        The channels of eq. 35: measured, and solved at the start and at the estimate. NaN
        where there is no steady state.
    held_out
        Predictions of the tows, or states, that a fit has not seen.
    at_truth : (n, 4) array or None
        Solved at the truth.
    residuals
        Differences of each channel's readings from the model at the estimate.
    innovations
        Differences before their window was used.
    course
        The windows, each with the estimate after it, as they came.
    history
        The steps of the iteration.
    law
        Law of the boards; None where the gear is not at hand, or has no boards.
    laws
        Quantities of this law; None where the gear is not at hand, or has no boards.
    paired
        True for a gear without boards, whose coefficients do nothing.
    chain
        Fit of the tows as chains of parts, of which the estimate is; None where the windows' own
        fit decides.
    chain_refused
        Reason for which it decides, in a sentence without its full stop; '' without one.
    sensors
        Each sensor, with its predictions by the gear file, the start and the estimate.

    Examples
    --------
    >>> import trawl_ros
    >>> report = trawl_ros.identify(['tow_1'], gear='coarse.yaml', motion=False)
    >>> report.measured.shape, report.rejected
    ((2, 4), {'unsteady': 1})
    """

    estimate: Estimate
    tows: tuple[str, ...]
    rejected: dict[str, int]
    found: dict[str, str]
    truth: FloatArray | None = None
    law: BoardLaw | None = None
    prior_weight: float = 1.0
    windows: tuple[SteadyWindow, ...] = ()
    measured: FloatArray = field(default_factory=lambda: stack(()))
    at_start: FloatArray = field(default_factory=lambda: stack(()))
    at_end: FloatArray = field(default_factory=lambda: stack(()))
    held_out: HeldOut = field(default_factory=HeldOut)
    at_truth: FloatArray | None = None
    residuals: tuple[ChannelResiduals, ...] = ()
    innovations: tuple[ChannelResiduals, ...] = ()
    course: tuple[WindowUsed, ...] = ()
    history: tuple[Progress, ...] = ()
    laws: KnownLaws | None = None
    paired: bool = False
    chain: MotionOutcome | None = None
    chain_refused: str = ''
    sensors: tuple[SensorComparison, ...] = ()

    @property
    def prior(self) -> ParameterVector:
        """Prior of the coefficients."""
        return self.estimate.prior

    @property
    def source(self) -> str:
        """Data of which the estimate is, in words."""
        if self.chain is not None:
            return f'{self.chain.what}, {self.chain.duration_s / 60.0:.0f} min'
        return f'{len(self.windows)} steady windows'

    @property
    def misfit(self) -> float:
        """Size of the residuals over that of all errors known of."""
        return self.estimate.birge_ratio if self.chain is None else self.chain.fit.misfit

    @property
    def spectrum(self) -> Spectrum:
        """Information of the data by direction."""
        return spectrum(self.estimate.covariance, self.prior, self.prior_weight)

    @property
    def inputs(self) -> FloatArray:
        """Port and starboard warp length (m) and speed (m/s) of each window, (n, 3)."""
        return np.array([[window.means[name] for name in INPUTS] for window in self.windows])

    @property
    def tow_of(self) -> IntArray:
        """Number of the tow (n,) of each window."""
        return np.array([window.tow for window in self.windows])

    @property
    def objectives(self) -> dict[str, float]:
        """Objective of eq. 35 at ``start``, ``end``, and the ``truth`` where that is known."""
        objectives = {
            'start': objective(self.at_start, self.measured),
            'end': objective(self.at_end, self.measured),
        }
        if self.at_truth is not None:
            objectives['truth'] = objective(self.at_truth, self.measured)
        return objectives

    @property
    def errors(self) -> dict[str, FloatArray]:
        """Mean normalised absolute errors (4,) at ``start``, ``end`` and ``held_out``."""
        return {
            'start': mnae(self.at_start, self.measured),
            'end': mnae(self.at_end, self.measured),
            'held_out': mnae(self.held_out.predicted, self.held_out.measured),
        }

    @property
    def by_tow(self) -> tuple[TowOutcome, ...]:
        """Outcomes of the tows."""
        outcomes = []
        for tow in map(int, np.unique(self.tow_of)):
            left_out, own = self.held_out, self.held_out.tows == tow
            windows = [window for window in self.windows if window.tow == tow]
            outcomes.append(
                TowOutcome(
                    tow=tow,
                    name=self.tows[tow],
                    windows=len(windows),
                    states=len({window.state for window in windows}),
                    held_out=mnae(left_out.predicted[own], left_out.measured[own]),
                )
            )
        return tuple(outcomes)


def report(
    identification: Identification,
    truth: FloatArray | None = None,
    folds: int = 5,
    tows: Sequence[str] = (),
    gear: GearRecord | None = None,
    on_progress: OnProgress = ignore,
    chain: MotionOutcome | None = None,
) -> Report:
    """Compute the report of a finished identification.

    Parameters
    ----------
    identification
        After its `finish`.
    truth
        True coefficients (q,), where known.
    folds
        Of the hold-out within a single tow.
    tows
        Names of the tows; numbered where none are given.
    gear
        Gear of the boards, for their laws at the angles they work at.
    on_progress
        Called before each fit of the hold-out.
    chain
        Fit of the same tows as chains of parts, whose estimate is reported; None for that of the
        windows' own fit.

    Raises
    ------
    TrawlError
        If there is no estimate, with the reason.
    """
    estimator, estimate = identification.estimator, identification.estimate
    if estimate is None:
        raise TrawlError(identification.why_not() or 'nothing is estimated')
    windows = estimator.windows
    number = 1 + max(window.tow for window in windows)
    own = [linear.state for linear in estimator.fit.windows]
    net = estimator.fit.net
    if chain is not None:
        biases = tuple(bias for bias in chain.tow_biases if bias.tow < number)
        estimate = replace(chain.estimate, windows=len(windows), tow_biases=biases)
        net = None if net is None else np.array([factor.value for factor in estimate.net])
    at_end = estimator.solve(estimate.values, net=net, own=own)
    at_start = estimator.solve(estimator.prior.start)
    cases, law = {'start': at_start, 'refitted': at_end}, None
    if gear is not None and gear.pair is None:
        law = build_board(gear).law
        written = gear.board.coefficients.array()
        known = np.array_equal(written, estimator.prior.start)
        by_gear = at_start if known else estimator.solve(written)
        cases = {'gear_file': by_gear, **cases}
    return Report(
        estimate=estimate,
        prior_weight=estimator.options.prior_weight,
        truth=truth,
        rejected=identification.rejected,
        found=identification.found,
        windows=windows,
        tows=tuple(tows) or tuple(f'tow {tow + 1}' for tow in range(number)),
        measured=stack([paper_values(window.means) for window in windows]),
        at_start=paper_rows(at_start),
        at_end=paper_rows(at_end),
        held_out=hold_out(estimator, folds, on_progress=on_progress)
        if chain is None
        else chain.held_out,
        at_truth=None if truth is None else paper_rows(estimator.solve(truth)),
        residuals=residuals(at_end),
        innovations=innovations(identification.course),
        course=tuple(identification.course),
        history=tuple(estimator.history),
        law=law,
        laws=None if law is None else _laws(law, at_end, estimate),
        paired=gear is not None and gear.pair is not None,
        sensors=compare_sensors(cases),
        chain=chain,
    )


def report_without_windows(
    chain: MotionOutcome,
    rejections: Sequence[Rejections],
    gear: GearRecord,
    truth: FloatArray | None = None,
) -> Report:
    """Compute the report of tows without a steady window.

    Parameters
    ----------
    chain
        Fit of the tows as chains of parts.
    rejections
        Of the recordings, none of which has a window.
    gear
        Gear of the boards.
    truth
        True coefficients (q,), where known.
    """
    every = Rejections()
    for rejected in rejections:
        every.counts.update(rejected.counts)
        every.sentences.update(rejected.sentences)
    return Report(
        estimate=chain.estimate,
        tows=chain.names,
        rejected={key: every.counts[key] for key in REASONS if every.counts[key]},
        found={key: every.sentences[key] for key in REASONS if key in every.sentences},
        truth=truth,
        law=build_board(gear).law,
        chain=chain,
    )


def interval_row(estimate: Estimate, truth: FloatArray | None, i: int) -> dict[str, object]:
    """Row of a coefficient: value, std and interval, and whether the truth is inside, if known."""
    low, high = float(estimate.low[i]), float(estimate.high[i])
    row: dict[str, object] = {
        'value': float(estimate.values[i]), 'std': float(estimate.std[i]), 'low': low, 'high': high,
    }  # fmt: skip
    if truth is not None:
        row |= {'truth': float(truth[i]), 'inside': bool(low <= truth[i] <= high)}
    return row


def coefficient_rows(report: Report) -> list[dict[str, object]]:
    """Return a row for each coefficient, all without unit."""
    estimate = report.estimate
    return [
        {
            'name': name,
            'start': float(estimate.prior.start[i]),
            **interval_row(estimate, report.truth, i),
            'shrink': float(estimate.shrink[i]),
            'determined': estimate.determined[i],
        }
        for i, name in enumerate(estimate.names)
    ]


def _laws(
    law: BoardLaw, linearised: Sequence[Linearised | None], estimate: Estimate
) -> KnownLaws | None:
    observables = [linear.state.observables for linear in linearised if linear is not None]
    if not observables:
        return None
    attack = [0.5 * (observed.port_attack + observed.starboard_attack) for observed in observables]
    angles = working_angles(observables)
    span = law_spans(law, estimate.values, angles, estimate.std)
    return KnownLaws(
        attack=(min(attack), max(attack)),
        angles=angles,
        quantities=law_quantities(law, estimate.values, estimate.covariance, angles, span),
    )
