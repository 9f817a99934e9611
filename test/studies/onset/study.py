"""Study of effects that begin during tows: how often and how soon they are found."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from studies.harness import Study, StudyResult, Work, option
from studies.onset.known import KNOWN, STATE_MIN
from studies.onset.limit import drawn_limit
from studies.onset.rows import ASKED_H, known_words, onset_rows, reasons_table, trials_table
from studies.onset.sizes import TIMES
from studies.onset.trial import CLEAN, EFFECT, OnsetTask, OnsetTrial, make_trial
from trawl_ros.diagnosis.onset.monitor import OnsetOptions
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Section

KNOWN_BY = {
    'draw': f'each coefficient is known to {KNOWN:g} of its std',
    'tow': 'known as `trawl identify` finds them in a tow before, by instruments with errors of '
    f'their own then: of the first states of the course, {STATE_MIN:g} min each',
}
"""Sentences on knowledge of the boards when the tow begins."""


@dataclass(frozen=True)
class OnsetPlan:
    """Size of the study; limits and errors were chosen by tows of other seeds."""

    gear: str = option('kaifuha', 'Gear file or name.')
    trials: int = option(18, 'Tows in which an effect begins.')
    clean: int = option(10, 'Tows in which none does.')
    minutes: float = option(35.0, 'Length of each tow.')
    seed: int = option(2500, 'Of all trials.')
    pictures: bool = option(False, 'Draw each tow that is made, as it was watched.')
    known: str = option(
        'draw', 'How boards are known when a tow begins: drawn around the truth, or as `trawl '
        'identify` finds them in a tow before.', choices=tuple(KNOWN_BY),
    )  # fmt: skip
    limit: int = option(0, 'Instead: draw the innovations of a clean tow so often for the limit.')

    def asked(self) -> dict[str, object]:
        """Settings of each trial, as plain values."""
        gear = load_gear(self.gear).model_dump(mode='json')
        return {'seed': self.seed, 'minutes': self.minutes, 'known': self.known, 'gear': gear}

    def tasks(self, work: Work) -> Iterator[OnsetTask]:
        """All trials; those with an effect and clean ones take turns, so that any part has both."""
        folder = str(work.folder) if self.pictures else ''
        for number in range(max(self.trials, self.clean)):
            for series, of in ((EFFECT, self.trials), (CLEAN, self.clean)):
                if number < of:
                    yield OnsetTask(
                        series, number, self.seed, self.gear, self.minutes, self.known, folder
                    )


def run(plan: OnsetPlan, work: Work) -> StudyResult:
    """Make the trials that are not there yet, or draw the limit."""
    if plan.limit:
        return StudyResult([Section('The limit', [_limit_row(plan)])])
    kept = work.trials(plan.asked(), OnsetTrial, make_trial, plan.tasks(work))
    return result(plan, [*kept.series(EFFECT)[: plan.trials], *kept.series(CLEAN)[: plan.clean]])


def result(plan: OnsetPlan, trials: list[OnsetTrial]) -> StudyResult:
    """Rows, table and record of trials."""
    made = [trial for trial in trials if not trial.why_not]
    refused = [
        f'{trial.number} ({trial.effect or "clean"}): {trial.why_not}'
        for trial in trials
        if trial.why_not
    ]
    text = f'Not made: {"; ".join(refused)}.' if refused else ''
    if plan.known == 'tow':
        text = f'{known_words(made)} {text}'.rstrip()
    section = Section(
        'Findings', onset_rows(made), tables=[trials_table(made), reasons_table(made)], text=text
    )
    return StudyResult([section], record={'trials': [asdict(trial) for trial in trials]})


def _limit_row(plan: OnsetPlan) -> MeasuredValue:
    drawn = drawn_limit(plan.gear, plan.seed, plan.minutes, plan.limit, ASKED_H)
    return MeasuredValue(
        f'rarity that white innovations exceed once in {ASKED_H:g} h',
        drawn.limit,
        note=f'of {drawn.hours:.0f} h drawn; the rarest of them is {drawn.largest:.2f}',
    )


def method(plan: OnsetPlan) -> str:
    """Method in sentences."""
    return (
        'Tows with random hauling, veering and speed steps. The plant has warps and bridles '
        'twice as fine as the model and no joined meshes, and is read by the default instruments; '
        'the net has 12 meshes around. Boards are drawn from the prior of the gear file until they '
        f'tow the course at rest, and {KNOWN_BY[plan.known]}. An '
        f'effect of {TIMES:g} times what steady windows detect, by a frozen table, begins between '
        'the 10th and the 20th minute. The class that watches in the node is fed with all samples. '
        f'Findings are raised beyond a rarity of {OnsetOptions().limit:g}.'
    )


STUDY = Study(
    'onset', 'onset', 'Effects that begin during a tow', OnsetPlan, {'trials': 1, 'clean': 1},
    run, method,
)  # fmt: skip
