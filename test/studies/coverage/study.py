"""Study of what intervals and predictions of identification are worth."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from studies.coverage.costs import LIVE_S, NODE, live_rows, replay, replay_rows
from studies.coverage.figure import trials_figure
from studies.coverage.knowledge import model_error_rows, planning_rows
from studies.coverage.rows import board_rows, coverage_rows, held_out_rows, spread_rows
from studies.coverage.trial import (
    HELD_OUT,
    TOWS,
    WRONG_BY,
    EstimationTask,
    EstimationTrial,
    run_trial,
)
from studies.harness import Study, StudyResult, Work, machine_words, option
from trawl_ros.core.progress import OnProgress, WorkProgress, step_counter
from trawl_ros.estimation.from_gear import board_prior
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.trials.linearised_plant import MeshResolution
from trawl_ros.lab.trials.readings import CORRELATION_S
from trawl_ros.report.pictures import Drawing

AROUND = 24

FINER = MeshResolution(AROUND, lines=2, unjoined=True)
"""Plant of the coverage; its net has more than twice as many nodes as the model's."""

DEFAULT_FINER = MeshResolution(around=48, lines=2, unjoined=True)
"""Plant for the default model."""


@dataclass(frozen=True)
class TrialSeries:
    """Series of trials of one kind; ``stated`` as in `EstimationTask`."""

    name: str
    words: str
    mesh: MeshResolution
    stated: bool


COVERAGE = TrialSeries('finer', 'a finer plant', FINER, stated=False)
BOUND = TrialSeries('alike', 'the model as its own plant', MeshResolution(AROUND), stated=True)
MOUTH = TrialSeries(
    'mouth', 'a plant with a finer mouth', MeshResolution(AROUND, lines=2, net=1.5), stated=False
)
SERIES = (COVERAGE, BOUND, MOUTH)


@dataclass(frozen=True)
class CoveragePlan:
    """Size of the study.

    The default seed is that of the report; what was chosen by looking at trials was chosen with 1.
    """

    gear: str = option('kaifuha', 'Gear file or name.')
    seed: int = option(22, 'Of all trials.')
    coverage: int = option(200, 'Trials with a finer plant.')
    bound: int = option(100, 'Trials with the model as plant.')
    mouth: int = option(30, 'Trials with a finer mouth.')
    around: int = option(AROUND, 'Meshes around the model net.')
    tows: int = option(len(TOWS), 'Tows of a trial.')
    trials_only: bool = option(False, 'Neither a planned trial, nor a replay, nor the node.')
    live_s: float = option(LIVE_S, 'Wall time (s) of the node in real time; 0 leaves it out.')

    def numbers(self) -> dict[str, int]:
        """Number of trials by the name of their series."""
        return {COVERAGE.name: self.coverage, BOUND.name: self.bound, MOUTH.name: self.mouth}

    def asked(self) -> dict[str, Any]:
        """Settings of each trial, as plain values."""
        gear = load_gear(self.gear).model_dump(mode='json')
        return {'seed': self.seed, 'around': self.around, 'tows': self.tows, 'gear': gear}

    def mesh(self, series: TrialSeries) -> MeshResolution:
        """Mesh of model and plant of a series."""
        return MeshResolution(**{**asdict(series.mesh), 'around': self.around})

    def tasks(self) -> Iterator[EstimationTask]:
        """All trials."""
        for series in SERIES:
            for number in range(self.numbers()[series.name]):
                yield EstimationTask(
                    series.name,
                    number,
                    self.seed,
                    self.gear,
                    self.mesh(series),
                    self.tows,
                    series.stated,
                )


def run(plan: CoveragePlan, work: Work) -> StudyResult:
    """Run the trials that are missing, and all else unless trials alone are wanted."""
    kept = work.trials(plan.asked(), EstimationTrial, run_trial, plan.tasks())
    coverage, bound, mouth = (
        # More trials than the plan has may be on file.
        kept.series(series.name)[: plan.numbers()[series.name]]
        for series in SERIES
    )
    prior = board_prior(load_gear(plan.gear))
    intervals = coverage_rows(coverage, COVERAGE.words, asked=True)
    if plan.mouth:
        intervals += coverage_rows(mouth, MOUTH.words, asked=False)
    sections = [
        Section('Intervals', intervals),
        Section('Spread of the estimates', spread_rows(bound, prior)),
        Section('Tows left out', held_out_rows(coverage)),
        Section('The trials', board_rows((*coverage, *bound, *mouth))),
    ]
    if not plan.trials_only:
        sections += _others(plan, work)
    drawing = Drawing('identification', CAPTION, trials_figure(coverage, bound, prior))
    return StudyResult(sections, [drawing])


def _others(plan: CoveragePlan, work: Work) -> list[Section]:
    """Sections that need no trials."""
    errors = _model_errors(plan, work.on_progress)
    work.on_progress(WorkProgress('planning'))
    planned = planning_rows(plan.gear)
    work.on_progress(WorkProgress('replay'))
    costs = replay_rows(replay(), replay(motion=True))
    if plan.live_s > 0.0:
        from studies.live_nodes import live_nodes

        live = live_nodes({NODE: {}}, plan.live_s, work.folder / 'log', work.on_progress)
        costs += live_rows(live)
    return [
        Section('Model and plant', errors),
        Section('A planned trial', planned),
        Section('Cost', costs),
    ]


def _model_errors(plan: CoveragePlan, on_progress: OnProgress) -> Sequence[MeasuredValue]:
    done = step_counter('model and plant', 2, on_progress)
    rows = []
    for mesh in (plan.mesh(COVERAGE), DEFAULT_FINER):
        rows += model_error_rows(plan.gear, mesh)
        done()
    return rows


CAPTION = (
    'Above: how often the 95 % interval of a coefficient covers the truth. Middle: root mean '
    'square error over the Bayesian Cramér–Rao bound. Below: errors on tows left out, those of a '
    'perfect model on the same data, and what is asked for. Bars are 95 % intervals, the green '
    'bands what is asked for.'
)


def method(plan: CoveragePlan) -> str:
    """Method in sentences."""
    return (
        f'A trial draws the twelve coefficients from the prior of the gear file, until the plant '
        f'can be towed with them in all its steady states: under water, with the boards within '
        f'the range of their law, and stable. It has {plan.tows} tows of '
        f'{len(TOWS[0])} states, 300 to 900 m of warp at 2.0 to 2.4 m/s, and a further tow of '
        f'{len(HELD_OUT)} states that is predicted and not fitted. Windows are not towed but '
        f'worked out: readings of a minute are the observables of the plant with noise as in '
        f'bags/sea_trial.yaml, of which a part is autoregressive of first order (correlation time '
        f'{CORRELATION_S:g} s), an offset and an '
        f'error of scale per sensor and tow, drawn from the channel table, and an offset per state '
        f'as the error budget has it; their mean and its stated error come from these readings as '
        f'in the finder. The model has a net of '
        f'{plan.around} meshes around its mouth. For the coverage and the tows left out the plant '
        f'has {plan.mesh(COVERAGE)}, and noise and biases of each kind of sensor are '
        f'{100.0 * WRONG_BY:g} % larger or smaller than stated, by chance. For the bound the plant '
        f'is the model, noise is as stated, nothing changes with the state, and the estimator is '
        f'told all three. '
        f'The catalogue of bad input is test/estimation/test_bad_input.py. '
        f'{machine_words()}'
    )


STUDY = Study(
    'coverage', 'identification', 'What identification is worth', CoveragePlan,
    {'coverage': 2, 'bound': 0, 'mouth': 0, 'around': 12, 'tows': 1, 'trials_only': True},
    run, method,
)  # fmt: skip
