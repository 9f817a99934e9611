"""Study of what a fit of all of a tow is worth, compared with that of its steady parts."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from studies.harness import Study, StudyResult, Work, machine_words, option
from studies.kept import KeptTrials
from studies.motion.detectable import (
    STATE_MINUTES,
    STATES,
    DetectableSizes,
    detectable_rows,
    run_detectable,
)
from studies.motion.plant import HELD_OUT
from studies.motion.rows import motion_rows
from studies.motion.trial import AUTOTRAWLED, MotionTask, MotionTrial, run_motion_trial
from trawl_ros.estimation.bag_motion import STRETCHES
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.trials.linearised_plant import MeshResolution

FINER, ALIKE, DETECTABLE = 'finer', 'alike', 'detectable'
WORDS = {
    FINER: 'a finer plant',
    ALIKE: 'the model as its own plant',
    AUTOTRAWLED: 'a finer plant under autotrawl',
}


@dataclass(frozen=True)
class MotionPlan:
    """Size of the study.

    What was chosen by looking at tows was chosen with seeds 41, 43, 48, 51, 54, 55 and 60 among
    others.
    """

    gear: str = option('kaifuha', 'Gear file or name.')
    seed: int = option(53, 'Of all trials.')
    trials: int = option(200, 'Trials with a finer plant.')
    alike: int = option(0, 'Trials with the model as plant.')
    autotrawled: int = option(
        0, 'Trials with a finer plant on a ship that heaves, under autotrawl.'
    )
    around: int = option(24, 'Meshes around the model net.')
    detectable: bool = option(False, 'Smallest effects that four tows show, too: 15 minutes.')
    live_s: float = option(0.0, 'Seconds of the sample trial played to both nodes in real time.')

    def numbers(self) -> dict[str, int]:
        """Number of trials by the name of their series."""
        return {FINER: self.trials, ALIKE: self.alike, AUTOTRAWLED: self.autotrawled}

    def asked(self) -> dict[str, object]:
        """Settings of each trial, as plain values."""
        gear = load_gear(self.gear).model_dump(mode='json')
        return {
            'seed': self.seed, 'around': self.around, 'stretches': asdict(STRETCHES),
            'gear': gear, 'calibration': 'as stated',
        }  # fmt: skip

    def task(self, series: str, number: int) -> MotionTask:
        """Task of one trial."""
        mesh = MeshResolution(self.around)
        if series in (FINER, AUTOTRAWLED):
            mesh = MeshResolution(self.around, lines=2, unjoined=True)
        return MotionTask(series, number, self.seed, self.gear, mesh)

    def tasks(self) -> Iterator[MotionTask]:
        """All trials."""
        for series, number in self.numbers().items():
            for trial in range(number):
                yield self.task(series, trial)


def run(plan: MotionPlan, work: Work) -> StudyResult:
    """Run the trials that are missing, and what else is wanted."""
    kept = work.trials(plan.asked(), MotionTrial, run_motion_trial, plan.tasks())
    sections = [
        Section(words[0].upper() + words[1:], motion_rows(
            kept.series(series)[: plan.numbers()[series]], words, asked=series != ALIKE))
        for series, words in WORDS.items()
        if plan.numbers()[series]
    ]  # fmt: skip
    if plan.detectable:
        sizes = _detectable(plan, work)
        sections.append(Section('Smallest detectable effects', detectable_rows(sizes)))
    if plan.live_s:
        from studies.motion.live import live_chain, live_chain_rows

        chain = live_chain(plan.live_s, work.folder / 'log', work.on_progress)
        sections.append(Section('In real time', live_chain_rows(chain)))
    return StudyResult(sections)


def _detectable(plan: MotionPlan, work: Work) -> DetectableSizes:
    """Sizes that are kept in a folder of their own, as they are no trial."""
    asked = {**plan.asked(), 'states': STATES, 'minutes': STATE_MINUTES}
    kept = KeptTrials(work.folder / DETECTABLE, asked, DetectableSizes, force=work.force)
    kept.run_missing(run_detectable, [plan.task(DETECTABLE, 0)], work.on_progress, workers=1)
    (found,) = kept.series(DETECTABLE)
    return found


def method(plan: MotionPlan) -> str:
    """Method in sentences."""
    return (
        'A trial draws the twelve coefficients from the prior of the gear file, and the added mass '
        'of the boards. It draws again until the plant can be towed with them, at rest and in '
        'time. The plant is towed along the commands of the scenario demo: five states in 59 '
        'minutes, in steps of 1 s. The default instruments read it. Errors of counters and spread '
        'sensor change with each command. Offset and scale of each sensor are drawn for each '
        'trial, as the channel table states them. The steady parts and the whole tow are fitted '
        'as by `trawl identify`, with and without `--steady`. Under autotrawl the ship heaves by '
        '2.5 m in 10 s, equal tension is held, and steps are half as long. '
        f'The model has a net of {plan.around} meshes around its mouth; a finer plant has '
        f'{plan.task(FINER, 0).mesh}. Both estimates, and the truth, predict {len(HELD_OUT)} '
        'steady states between those of the course, read by instruments with noise and biases as '
        'stated. '
        f'{_of_detectable(plan)}{machine_words()}'
    )


def _of_detectable(plan: MotionPlan) -> str:
    if not plan.detectable:
        return ''
    return (
        'Of the smallest detectable effects the model is its own plant: four tows of three '
        f'states, {STATE_MINUTES:g} min each with the hauling that leads to it, two on either '
        'course, are towed in time and read once. By their windows a size is detectable as '
        '`trawl diagnose` has it in `smallest_detectable`; by all of them likewise, and by the '
        'same limit, from derivatives in time by coefficients, effects and all that errs, '
        'linearised once, with errors as the fit in motion states them, and trends of '
        "the model's error with length as for windows. No effect is hidden, so that nothing is "
        'said of its name. '
    )


STUDY = Study(
    'motion', 'motion', 'What all of a tow is worth', MotionPlan, {'trials': 2, 'around': 12},
    run, method,
)  # fmt: skip
