"""Study of the identification: plan of its trials, and their execution."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from trawl_ros.core.progress import OnProgress, WorkProgress, ignore, step_counter
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.running.live_nodes import live_nodes
from trawl_ros.lab.studies.identification.costs import (
    LIVE_S,
    NODE,
    live_rows,
    replay,
    replay_rows,
)
from trawl_ros.lab.studies.identification.figure import trials_figure
from trawl_ros.lab.studies.identification.kept import KeptTrials
from trawl_ros.lab.studies.identification.knowledge import model_error_rows, planning_rows
from trawl_ros.lab.studies.identification.plant import TOWS, Cut
from trawl_ros.lab.studies.identification.rows import (
    board_rows,
    coverage_rows,
    held_out_rows,
    spread_rows,
)
from trawl_ros.lab.studies.identification.trial import EstimationTrial, Task, run_trial

SEED = 22
"""Of the study as it is reported; what was chosen by looking at trials was chosen with 1."""

FINER = Cut(around=24, lines=2, unjoined=True)
"""Plant of the coverage; its net has more than twice as many nodes as the model's."""

AS_MODEL = Cut(around=24)
FAR_FINER = Cut(around=24, lines=2, net=1.5)
DEFAULT_FINER = Cut(around=48, lines=2, unjoined=True)
"""Plant beside the default model."""


@dataclass(frozen=True)
class TrialSeries:
    """Series of trials of one kind; ``stated`` as in `Task`."""

    name: str
    words: str
    cut: Cut
    stated: bool


COVERAGE = TrialSeries('finer', 'a finer plant', FINER, stated=False)
BOUND = TrialSeries('alike', 'the model as its own plant', AS_MODEL, stated=True)
MOUTH = TrialSeries('mouth', 'a plant with a finer mouth', FAR_FINER, stated=False)
SERIES = (COVERAGE, BOUND, MOUTH)


@dataclass(frozen=True)
class EstimationStudyPlan:
    """Plan of the study's size.

    Attributes
    ----------
    gear
        File or name.
    seed
        Of all trials.
    coverage, bound, mouth
        Number of trials of each series.
    around
        Meshes around the mouth of the model's net.
    tows
        Number of `TOWS` that a trial fits.
    live_s
        Wall time (s) for which the node is watched; 0 leaves it out.
    """

    gear: str = 'kaifuha'
    seed: int = SEED
    coverage: int = 200
    bound: int = 100
    mouth: int = 30
    around: int = FINER.around
    tows: int = len(TOWS)
    live_s: float = LIVE_S

    def numbers(self) -> dict[str, int]:
        """Number of trials by the name of their series."""
        return {COVERAGE.name: self.coverage, BOUND.name: self.bound, MOUTH.name: self.mouth}

    def asked(self) -> dict[str, Any]:
        """Settings of each trial, as plain values."""
        gear = load_gear(self.gear).model_dump(mode='json')
        return {'seed': self.seed, 'around': self.around, 'tows': self.tows, 'gear': gear}

    def cut(self, series: TrialSeries) -> Cut:
        """Mesh of model and plant of a series."""
        return Cut(**{**asdict(series.cut), 'around': self.around})


@dataclass(frozen=True)
class StudyResult:
    """Result: all rows by section, and a figure of the trials."""

    sections: tuple[Section, ...]
    figure: Figure


def run_study(
    plan: EstimationStudyPlan,
    folder: Path,
    on_progress: OnProgress = ignore,
    *,
    scheduler: str | None = None,
    force: bool = False,
    small: bool = False,
) -> StudyResult:
    """Run the study, or the trials it lacks.

    Parameters
    ----------
    plan
        Size of the study.
    folder
        Takes the trials, and what nodes say.
    on_progress
        Called after each trial and each part of the rest.
    scheduler
        Address of a Dask cluster for the trials; what is timed runs on this machine.
    force
        True to begin anew.
    small
        True to leave out all but the trials.
    """
    kept = run_trials(plan, folder, on_progress, scheduler=scheduler, force=force)
    coverage, bound, mouth = (trials_of(plan, kept, series) for series in SERIES)
    prior = board_prior(load_gear(plan.gear))
    sections: list[Section] = [
        Section('Intervals', (*coverage_rows(coverage, COVERAGE.words, asked=True),
                       *(coverage_rows(mouth, MOUTH.words, asked=False) if plan.mouth else ()))),
        Section('Spread of the estimates', spread_rows(bound, prior)),
        Section('Tows left out', held_out_rows(coverage)),
        Section('The trials', board_rows((*coverage, *bound, *mouth))),
    ]  # fmt: skip
    if not small:
        done = step_counter('model beside plant', 2, on_progress)
        rows = []
        for cut in (plan.cut(COVERAGE), DEFAULT_FINER):
            rows += model_error_rows(plan.gear, cut)
            done()
        sections.append(Section('Model and plant', rows))
        on_progress(WorkProgress('planning'))
        sections.append(Section('A planned trial', planning_rows(plan.gear)))
        on_progress(WorkProgress('replay'))
        costs = replay_rows(replay(), replay(motion=True))
        if plan.live_s > 0.0:
            costs += live_rows(live_nodes({NODE: {}}, plan.live_s, folder / 'log', on_progress))
        sections.append(Section('Cost', costs))
    return StudyResult(tuple(sections), trials_figure(coverage, bound, prior))


def run_trials(
    plan: EstimationStudyPlan,
    folder: Path,
    on_progress: OnProgress = ignore,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    force: bool = False,
) -> KeptTrials[EstimationTrial]:
    """Run the trials that are missing.

    Parameters
    ----------
    plan
        Numbers of trials.
    folder
        Takes the trials, one by one.
    on_progress
        Called after each of them.
    scheduler, workers
        As in `trawl_ros.core.parallel.run_tasks`.
    force
        True to begin anew.

    Raises
    ------
    TrawlError
        If trials of another plan are kept there, or one cannot be made.
    """
    kept = KeptTrials(folder, plan.asked(), EstimationTrial, force=force)
    kept.run_missing(run_trial, _tasks(plan), on_progress, scheduler=scheduler, workers=workers)
    return kept


def trials_of(
    plan: EstimationStudyPlan, kept: KeptTrials[EstimationTrial], series: TrialSeries
) -> tuple[EstimationTrial, ...]:
    """Trials of a series in a plan; more may be on file."""
    return kept.series(series.name)[: plan.numbers()[series.name]]


def _tasks(plan: EstimationStudyPlan) -> Iterator[Task]:
    for series in SERIES:
        for number in range(plan.numbers()[series.name]):
            yield Task(
                series.name,
                number,
                plan.seed,
                plan.gear,
                plan.cut(series),
                plan.tows,
                series.stated,
            )
