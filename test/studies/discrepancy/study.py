"""Study of blind trials: how often what is hidden is named, and how good probabilities are."""

from collections.abc import Sequence
from dataclasses import dataclass

from studies.discrepancy.temperature import best_temperature
from studies.discrepancy.trial import BlindTask, BlindTrial, rules_hash, run_blind
from studies.harness import Study, StudyResult, Work, machine_words, option
from trawl_ros.lab.missing_effect.calibration import CalibrationOptions, certified_cut
from trawl_ros.lab.missing_effect.plan import SERIES_SHARES, drawn_spec
from trawl_ros.lab.missing_effect.score_report import (
    confusion_table,
    reliability_drawing,
    trials_words,
)
from trawl_ros.lab.missing_effect.scoring import all_sections
from trawl_ros.lab.report.page import Section, TextTable
from trawl_ros.lab.trials.plant import FINER_MESH


@dataclass(frozen=True)
class BlindStudyPlan:
    """Size of the study; options of the inference were fitted on trials of seeds 101 to 103."""

    gear: str = option('kaifuha', 'Gear file or name.')
    seed: int = option(201, 'Of all trials.')
    trials: int = option(300, 'Number of trials.')

    def asked(self) -> dict[str, object]:
        """Return the settings of each trial."""
        return {'gear': self.gear, 'seed': self.seed, 'around': FINER_MESH.around}


def run(plan: BlindStudyPlan, work: Work) -> StudyResult:
    """Make and diagnose the trials that are missing, and score all."""
    tasks = []
    for number in range(plan.trials):
        spec = drawn_spec(plan.seed, number)
        tasks.append(BlindTask(spec.series, number, plan.seed, plan.gear, spec))
    kept = work.trials(plan.asked(), BlindTrial, run_blind, tasks)
    trials = [own for name in SERIES_SHARES for own in kept.series(name)]
    tested = [own for own in trials if own.answer is not None]
    cases = [own.case for own in tested]
    sections = [
        *all_sections(cases),
        Section('Confusions', tables=[confusion_table(cases)]),
        Section('The trials', tables=[_table(trials)]),
    ]
    options = CalibrationOptions()
    record = {
        'rules_sha256': sorted({own.rules for own in trials}),
        'best_temperature': best_temperature([own for own in tested if own.explanations]),
        'certified_cut': certified_cut(cases, options),
    }
    drawing = reliability_drawing({'trawl diagnose': cases}, options)
    return StudyResult(sections, [drawing], record)


def _table(trials: Sequence[BlindTrial]) -> TextTable:
    rows = []
    for series in SERIES_SHARES:
        own = [trial.answer is not None for trial in trials if trial.series == series]
        rows.append((series, str(sum(own)), str(len(own) - sum(own))))
    return TextTable('Numbers of trials', ('series', 'tested', 'not possible'), tuple(rows))


def method(plan: BlindStudyPlan) -> str:
    """Return the method in sentences."""
    return f'{trials_words()} Rules {rules_hash()[:12]}. {machine_words()}'


STUDY = Study(
    'discrepancy', 'discrepancy', 'How often the missing effect is named', BlindStudyPlan,
    {'trials': 6}, run, method,
)  # fmt: skip
