"""Study of blind trials: how often hidden effects are found and named."""

import json
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

import numpy as np

from studies.discrepancy.costs import cost_rows
from studies.discrepancy.figure import verdicts_figure
from studies.discrepancy.plan import (
    IN_BAGS,
    PLANTS,
    POOR_STRENGTH,
    BlindStudyPlan,
)
from studies.discrepancy.rows import all_sections
from studies.discrepancy.stages import read_classes, rules_hash, run_blind
from studies.harness import Study, StudyResult, Work, machine_words
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import appending
from trawl_ros.core.version import __version__
from trawl_ros.diagnosis import rules
from trawl_ros.gear.load import load_gear
from trawl_ros.lab.report.page import Section, TextTable
from trawl_ros.lab.trials.hidden_effects.on_deck import FRICTION, NORMAL_DRAG
from trawl_ros.lab.trials.making import DROPOUTS, WRONG_BY
from trawl_ros.lab.trials.towing import HAULING_SPEED
from trawl_ros.lab.trials.tows import FULL
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.lab.trials.verdicts import Classes


def run(plan: BlindStudyPlan, work: Work) -> StudyResult:
    """Hide effects in trials of another plant, and count how often they are found and named."""
    if work.shard != (1, 1):
        raise TrawlError('--shard: not possible here; --scheduler shares the trials')
    load_gear(plan.gear)
    trials = run_blind(plan, work)
    found = result(plan, work.folder, trials, read_classes(work.folder))
    log_scoring(work.folder, plan, len(trials), found.sections)
    return found


def result(
    plan: BlindStudyPlan, folder: Path, trials: Sequence[Scored], classes: Classes
) -> StudyResult:
    """Sections and the figure of scored trials, whose costs are kept in a folder."""
    sections = [*all_sections(trials, classes), Section('What it takes', cost_rows(folder))]
    if plan.sample:
        sections = [own for section in sections if (own := _measured(section)).rows]
    sections.append(Section('The trials', tables=[_made_table(trials, classes)]))
    return StudyResult(sections, [verdicts_figure(trials, classes)])


def _made_table(trials: Sequence[Scored], classes: Classes) -> TextTable:
    """Numbers of trials, why some are not testable, and names as good as an effect's own."""
    not_testable = [trial for trial in trials if trial.diagnosis is None]
    why = Counter(re.split(' of |:', trial.key['why_not'])[0] for trial in not_testable)
    wide = [
        f'{name} or {", ".join(other for other in names if other != name)}'
        for name, names in classes.items()
        if len(names) > 1
    ]
    return TextTable(
        '',
        ('what', 'found'),
        (
            ('trials', str(len(trials))),
            (
                'not testable: the size would not be possible, or the gear could not be towed',
                ', '.join(f'{name} {count}' for name, count in why.most_common()) or 'none',
            ),
            ("as good as an effect's own name", '; '.join(wide) or 'nothing'),
        ),
    )


def _measured(section: Section) -> Section:
    """Section without what a sample has no trials of."""
    rows = tuple(row for row in section.rows if np.isfinite(row.value) and (row.value or row.note))
    return replace(section, rows=rows)


def method(plan: BlindStudyPlan) -> str:
    """Method in sentences."""
    in_time = sum(spec.form == 'dynamic' for spec in plan.specs())
    tows, states, before = len(FULL.tows), len(FULL.tows[0].states), FULL.baseline
    return (
        f'A trial has {tows} tows of {states} steady states, 300 to 900 m of warp at 2.0 to '
        f'2.4 m/s, eastward and back in turn; nothing is hidden in the first {before}, which the '
        'diagnosis is told are a baseline. Every third of the others is kept back from naming, '
        'and shows what the repair is worth. The plant is not the model: '
        f'{plan.mesh}, netting and its ropes with {NORMAL_DRAG:g} times the drag across and '
        f'{FRICTION:g} times that along the twine; {PLANTS} plants have boards drawn from half of '
        "the prior's spread. Windows are worked out from steady states of the plant with noise of "
        'which a part is autoregressive, offsets and errors of scale by sensor and tow, an offset '
        f'by state as the error budget has it, all of these {100.0 * WRONG_BY:g} % larger or '
        'smaller than stated, states some metres and '
        f'hundredths of m/s off the plan, and {100.0 * DROPOUTS:g} % of the means of optional '
        'channels missing. What is hidden is written apart from the catalogue, through the hooks '
        'of the model, with a shape drawn for each trial. Its strength is a multiple of the '
        "smallest detectable size by the plant's own likelihood, found before any diagnosis; of an "
        'effect outside the catalogue only what neither coefficients nor the best effect of the '
        'catalogue could mimic counts. The diagnosis runs in a process of its own and reads a '
        'file of windows with a random name; the score sees diagnosis.json and the key alone. What '
        "is as good as an effect's own name was found before any trial was made, from the cosines "
        f'of the plan. One in {IN_BAGS} of the trials is made as bags too, of '
        'every reading. '
        f'{in_time} trials of a day, of two to four tows of three or four states, with a baseline '
        'or without, were made as windows and towed in time, warps hauled and paid out at '
        f'{HAULING_SPEED:g} m/s; the sizes hidden, plants and instruments are the same for both, '
        'noise and windows are not. Two or three effects at once are each as strong as if alone. '
        'Poor trials have, after the same baseline, three '
        f'tows of one course and one length of warps, and effects of {POOR_STRENGTH:g} times the '
        'smallest detectable size that look alike in such; what they leave open is towed on as '
        'the first proposal has it, and diagnosed again. '
        f'{_drawn(plan)}{machine_words()}'
    )


def _drawn(plan: BlindStudyPlan) -> str:
    """Sentence on a sample; none where all trials are made."""
    if not plan.sample:
        return ''
    number = sum(spec.form == 'windows' for spec in replace(plan, sample=0).specs())
    return f'Of {number} trials {plan.sample} were drawn by chance, before any was made. '


SCORINGS = 'scorings.jsonl'


def log_scoring(
    folder: Path, plan: BlindStudyPlan, trials: int, sections: Sequence[Section]
) -> None:
    """Add a line: when, of which plan and rules, which targets were asked for, and missed."""
    asked = [row for section in sections for row in section.rows if row.target is not None]
    source = Path(rules.__file__).read_bytes()
    line = {
        'time': datetime.now(UTC).isoformat(timespec='seconds'),
        'version': __version__,
        'rules_sha256': sha256(source).hexdigest(),
        'diagnosis_sha256': rules_hash(),
        'plan': asdict(plan),
        'trials': trials,
        'asked': len(asked),
        'missed': [row.what for row in asked if not row.ok],
    }
    with appending(folder / SCORINGS) as log:
        log.write(json.dumps(line) + '\n')


STUDY = Study(
    'discrepancy', 'discrepancy', 'How often the missing effect is found', BlindStudyPlan,
    {'sample': 4}, run, method,
)  # fmt: skip
