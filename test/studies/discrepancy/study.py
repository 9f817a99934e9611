"""Study of blind trials: how often what is hidden is named, and what probabilities are worth."""

from collections.abc import Sequence

from studies.discrepancy.calibration import best_temperature, certified_cut, log_score
from studies.discrepancy.plan import TRIALS_OF_A_PLANT, BlindStudyPlan
from studies.discrepancy.rows import all_sections
from studies.discrepancy.trial import BlindTask, BlindTrial, rules_hash, run_blind
from studies.harness import Study, StudyResult, Work, machine_words
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.lab.report.page import Section, TextTable
from trawl_ros.lab.trials.making import WRONG_BY
from trawl_ros.lab.trials.plant import FINER


def run(plan: BlindStudyPlan, work: Work) -> StudyResult:
    """Make and diagnose the trials that are missing, and score all."""
    tasks = []
    for number in range(plan.trials):
        spec = plan.spec(number)
        tasks.append(BlindTask(spec.series, number, plan.seed, plan.gear, spec))
    kept = work.trials(plan.asked(), BlindTrial, run_blind, tasks)
    trials = [
        own for name in ('clean', 'alone', 'outside', 'pair') for own in kept.series(name)
    ]  # fmt: skip
    sections = [*all_sections(trials), Section('The trials', tables=[_table(trials)])]
    fitted = [own for own in trials if own.explanations]
    options = InferenceOptions()
    best = best_temperature(fitted)
    record = {
        'rules_sha256': sorted({own.rules for own in trials}),
        'best_temperature': best,
        'log_score': log_score(fitted, options.temperature),
        'log_score_best': log_score(fitted, best),
        'certified_cut': certified_cut(fitted, options.temperature),
        'certified_cut_best': certified_cut(fitted, best),
    }
    return StudyResult(sections, record=record)


def _table(trials: Sequence[BlindTrial]) -> TextTable:
    tested = [own for own in trials if own.verdict]
    rows = tuple(
        (series, str(len([own for own in tested if own.series == series])),
         str(len([own for own in trials if own.series == series and not own.verdict])))
        for series in ('clean', 'alone', 'outside', 'pair')
    )  # fmt: skip
    return TextTable('Numbers of trials', ('series', 'tested', 'not possible'), rows)


def method(plan: BlindStudyPlan) -> str:
    """Return the method in sentences."""
    return (
        'A trial has one baseline and three tows of three steady states, of which the second is '
        'held out. The plant is not the model: '
        f'{FINER}, and netting of another law of drag; boards are drawn from half of the spread of '
        f'the prior, anew every {TRIALS_OF_A_PLANT} trials. Windows are worked out from steady '
        'states, with noise of which a '
        f'part is autoregressive, and offsets and errors of scale {WRONG_BY:.0%} larger or smaller '
        'than stated. What is hidden is written apart from the library, with a shape drawn for '
        'each trial; its strength is a multiple of the smallest size that is detectable by the '
        "plant's own likelihood. Which leaves and nodes are right was fixed before "
        f'(`trawl_ros/lab/trials/answers.py`). Rules {rules_hash()[:12]}. {machine_words()}'
    )


STUDY = Study(
    'discrepancy', 'discrepancy', 'How often the missing effect is named', BlindStudyPlan,
    {'trials': 6}, run, method,
)  # fmt: skip
