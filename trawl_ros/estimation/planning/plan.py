# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Trial planning: the most informative trial in a given time, compared with the paper's sweep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.progress import OnProgress, WorkProgress, ignore
from trawl_ros.estimation.fit.estimator_options import EstimatorOptions
from trawl_ros.estimation.fit.laws import (
    QUANTITIES,
    WELL_KNOWN,
    LawQuantities,
    WorkingAngles,
    law_spans,
    working_angles,
)
from trawl_ros.estimation.from_gear import board_prior, predictor_for
from trawl_ros.estimation.planning.duration import Leg, vessel_limits
from trawl_ros.estimation.planning.in_motion import KnownInMotion, known_in_motion
from trawl_ros.estimation.planning.limits import limits_of
from trawl_ros.estimation.planning.search import Designer, DesignProblem
from trawl_ros.estimation.planning.states import (
    Explorer,
    Limits,
    Manoeuvre,
    ManoeuvreChoice,
    Refused,
    TowableManoeuvre,
    explore,
)
from trawl_ros.estimation.planning.sweep import SweepTrial, best_sweep, paper_noise
from trawl_ros.estimation.planning.windows import TABLE_NOISE
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.gear.records import GearRecord
from trawl_ros.model.gear_model import build_board

LEAST_LEGS = 2
"""One steady state cannot tell a law's slope from its value."""


@dataclass(frozen=True)
class Gain:
    """Gain of a leg: number of well-known quantities after it, and the one it improves most.

    ``before`` and ``after`` are the std of ``quantity`` as a share of its law's span.
    """

    well_known: int
    quantity: str
    before: float
    after: float


@dataclass(frozen=True)
class TrialPlan:
    """Planned trial.

    Attributes
    ----------
    gear
        Its name.
    problem
        Design problem that the plan solves.
    choice
        The manoeuvres among which was chosen, and those that are not to be had.
    trial
        The plan.
    gains
        Gain of each of its legs.
    limits
        Quantity that is not well known after it → what keeps it from that.
    before
        Quantities of the laws before any tow.
    sweeps
        The paper's sweep in the same time, with all planned channels and with the paper's.
    in_motion
        What a fit of the whole tow will know; None where `towed_plan` was not called, or the model
        cannot be towed along any of the plan.
    windows_only
        Why it cannot; '' if it can.

    Examples
    --------
    >>> import trawl_ros
    >>> from trawl_ros.estimation.planning.states import Limits
    >>> limits = Limits(lengths=(300.0,), speeds=(2.1, 2.3), shorter=())
    >>> plan = trawl_ros.plan_trial('coarse.yaml', hours=1.0, limits=limits)
    >>> plan.gains[-1].well_known >= plan.gains[0].well_known
    True
    """

    gear: str
    problem: DesignProblem
    choice: ManoeuvreChoice
    trial: SweepTrial
    gains: tuple[Gain, ...]
    limits: Mapping[str, str]
    before: LawQuantities
    sweeps: tuple[SweepTrial, ...]
    in_motion: KnownInMotion | None = None
    windows_only: str = ''


def plan_for(
    gear: GearRecord,
    *,
    hours: float = 6.0,
    limits: Limits | None = None,
    windows: WindowOptions | None = None,
    estimator: EstimatorOptions | None = None,
    on_progress: OnProgress = ignore,
) -> TrialPlan:
    """Plan a trial: optimal experiment design over manoeuvres, within the given time.

    It is planned with the board as identification starts, for nothing more is known before. All
    its legs can be towed with that board and with the one that the gear file describes.

    Parameters
    ----------
    gear
        From `load_gear`.
    hours
        Time at sea, from the first leg's beginning to the last one's end.
    limits
        Among which manoeuvres one may choose.
    windows, estimator
        Criteria of a steady window; options of the estimator.
    on_progress
        Called after each steady state.

    Raises
    ------
    TrawlError
        If there is nothing to choose from, or no time for two legs.
    """
    gear.require_boards('for whose coefficients a trial could be planned')
    prior = board_prior(gear)
    predictor = predictor_for(gear)
    explorer = Explorer(predictor, prior.start, limits)
    choice = explore(explorer, on_progress)
    problem = problem_for(
        gear, choice, prior.start, hours=hours, windows=windows, estimator=estimator
    )
    filed = Explorer(predictor, gear.board.coefficients.array(), limits)
    explored: dict[Manoeuvre, TowableManoeuvre] = {}
    while True:
        designer = Designer(problem, choice.candidates)
        legs = designer.best()
        if len(legs) < LEAST_LEGS:
            raise TrawlError(
                f'{hours:g} h are time for {len(legs)} of at least {LEAST_LEGS} legs, each held '
                'until the gear has settled and its windows are taken; expected more hours'
            )
        sweep = best_sweep(designer)
        lost = _look_up((*legs, *sweep), filed, choice.candidates, explored, on_progress)
        if not lost:
            break
        choice = choice.without(lost)
    there = _as_filed(problem, list(explored.values()), gear)
    data_alone = replace(problem, estimator=replace(problem.estimator, prior_weight=0.0))
    trials = []
    for name, chosen, noise in (
        ('plan', legs, TABLE_NOISE),
        ('sweep', sweep, TABLE_NOISE),
        ("sweep, the paper's channels", sweep, paper_noise()),
    ):
        done = [leg.manoeuvre for leg in chosen]
        known, by_data, as_filed = (
            Designer(asked, candidates, noise).quantities(done)
            for asked, candidates in (
                (problem, choice.candidates),
                (data_alone, choice.candidates),
                (there, explored.values()),
            )
        )
        trials.append(SweepTrial(name, chosen, known, by_data, as_filed))
    trial = trials[0]
    return TrialPlan(
        gear=gear.name,
        problem=problem,
        choice=choice,
        trial=trial,
        gains=_gains(designer, trial.manoeuvres),
        limits=limits_of(designer, trial.manoeuvres, trial.known),
        before=problem.quantities(np.diag(prior.std**2)),
        sweeps=tuple(trials[1:]),
    )


def towed_plan(gear: GearRecord, plan: TrialPlan, on_progress: OnProgress = ignore) -> TrialPlan:
    """Return a plan with what a fit of its whole tow will know, or why that is not known.

    Parameters
    ----------
    gear, plan
        Gear, and what `plan_for` returned for it.
    on_progress
        Called after each stretch that was towed.
    """
    try:
        known = known_in_motion(gear, plan.trial, plan.problem, on_progress)
    except TrawlError as reason:
        return replace(plan, windows_only=str(reason))
    return replace(plan, in_motion=known)


def problem_for(
    gear: GearRecord,
    choice: ManoeuvreChoice,
    coefficients: FloatArray,
    *,
    hours: float,
    windows: WindowOptions | None = None,
    estimator: EstimatorOptions | None = None,
) -> DesignProblem:
    """Return the design problem for a board (q,) and the manoeuvres explored with it."""
    prior, law, angles = board_prior(gear), build_board(gear).law, _angles(choice.candidates)
    return DesignProblem(
        law=law,
        coefficients=np.array(coefficients),
        prior=prior,
        angles=angles,
        span=law_spans(law, prior.start, angles, prior.std),
        estimator=estimator or EstimatorOptions(),
        windows=windows or WindowOptions(),
        vessel=vessel_limits(gear, [candidate.manoeuvre for candidate in choice.candidates]),
        minutes=60.0 * hours,
    )


def _angles(candidates: Sequence[TowableManoeuvre]) -> WorkingAngles:
    return working_angles([candidate.part.state.observables for candidate in candidates])


def _look_up(
    legs: Sequence[Leg],
    explorer: Explorer,
    near: Sequence[TowableManoeuvre],
    explored: dict[Manoeuvre, TowableManoeuvre],
    on_progress: OnProgress,
) -> dict[Manoeuvre, Refused]:
    """Solve the legs with another board, from known states near them.

    Return those that it has no steady state for.
    """
    wanted = sorted({leg.manoeuvre for leg in legs} - explored.keys())
    lost = {}
    for done, manoeuvre in enumerate(wanted, 1):
        state = explorer.look_up(manoeuvre, near)
        if isinstance(state, TowableManoeuvre):
            explored[manoeuvre] = state
        else:
            lost[manoeuvre] = state
        on_progress(WorkProgress('the plan with the board of the file', done, len(wanted)))
    return lost


def _gains(designer: Designer, manoeuvres: Sequence[Manoeuvre]) -> tuple[Gain, ...]:
    gains = []
    before = designer.quantities([])
    for number in range(1, len(manoeuvres) + 1):
        after = designer.quantities(manoeuvres[:number])
        # As the search counts it: the logarithm, and little of it for what is well known.
        term = [np.log1p((known.ratio / WELL_KNOWN) ** 2) for known in (before, after)]
        most = int(np.argmax(term[0] - term[1]))
        gains.append(
            Gain(
                int(after.well_known.sum()),
                QUANTITIES[most],
                float(before.ratio[most]),
                float(after.ratio[most]),
            )
        )
        before = after
    return tuple(gains)


def _as_filed(
    problem: DesignProblem, candidates: Sequence[TowableManoeuvre], gear: GearRecord
) -> DesignProblem:
    """The same design problem with the board that the gear file describes."""
    coefficients, angles = gear.board.coefficients.array(), _angles(candidates)
    span = law_spans(problem.law, coefficients, angles)
    return replace(problem, coefficients=coefficients, angles=angles, span=span)
