"""Report of the blind tests."""

import json
import os
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, replace
from datetime import datetime, timezone
from hashlib import sha256
from pathlib import Path

import numpy as np

from trawl_ros.core.files import appending
from trawl_ros.core.version import __version__
from trawl_ros.diagnosis import rules
from trawl_ros.lab.report.machine import cpu_model, software
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, Section, write_page
from trawl_ros.lab.studies.discrepancy.hidden_effects.on_deck import FRICTION, NORMAL_DRAG
from trawl_ros.lab.studies.discrepancy.scoring.costs import cost_rows
from trawl_ros.lab.studies.discrepancy.scoring.figure import verdicts_figure
from trawl_ros.lab.studies.discrepancy.scoring.rows import all_sections
from trawl_ros.lab.studies.discrepancy.scoring.rules_hash import rules_hash
from trawl_ros.lab.studies.discrepancy.scoring.verdicts import Classes
from trawl_ros.lab.studies.discrepancy.trials.making import DROPOUTS, WRONG_BY
from trawl_ros.lab.studies.discrepancy.trials.plan import (
    IN_BAGS,
    PLANTS,
    POOR_STRENGTH,
    BlindStudyPlan,
)
from trawl_ros.lab.studies.discrepancy.trials.towing import HAULING_SPEED
from trawl_ros.lab.studies.discrepancy.trials.tows import FULL
from trawl_ros.lab.studies.discrepancy.trials.trial import Scored

REPORT = 'discrepancy.md'


def write_discrepancy(
    folder: Path, plan: BlindStudyPlan, trials: Sequence[Scored], classes: Classes
) -> list[MeasuredValue]:
    """Write ``discrepancy.json``, ``.md``, ``.html`` and ``.png``, log it, and give the rows."""
    page = Page(
        name='discrepancy',
        title='How often the missing effect is found',
        command=f'trawl study discrepancy{_options(plan)}',
        method=_method(plan, trials, classes),
    )
    sections = [*all_sections(trials, classes), Section('What it takes', cost_rows(folder))]
    if plan.sample:
        sections = [own for section in sections if (own := _measured(section)).rows]
    rows = write_page(folder, page, sections, [verdicts_figure(trials, classes)])
    log_scoring(folder, plan, len(trials), rows)
    return rows


def _measured(section: Section) -> Section:
    """Section without what a sample has no trials of."""
    rows = tuple(row for row in section.rows if np.isfinite(row.value) and (row.value or row.note))
    return replace(section, rows=rows)


def _options(plan: BlindStudyPlan) -> str:
    usual = asdict(BlindStudyPlan())
    words = [f'--{key} {value}' for key, value in asdict(plan).items() if value != usual[key]]
    return ''.join(f' {word}' for word in words)


def _method(plan: BlindStudyPlan, trials: Sequence[Scored], classes: Classes) -> str:
    """Method in sentences."""
    not_testable = [trial for trial in trials if trial.diagnosis is None]
    why = Counter(re.split(' of |:', trial.key['why_not'])[0] for trial in not_testable)
    listed = ', '.join(f'{name} {count}' for name, count in why.most_common()) or 'none'
    versions = ', '.join(f'{name} {version}' for name, version in software().items())
    in_time = sum(spec.form == 'dynamic' for spec in plan.specs())
    tows, states, before = len(FULL.tows), len(FULL.tows[0].states), FULL.baseline
    return (
        f'A trial has {tows} tows of {states} steady states, 300 to 900 m of warp at 2.0 to '
        f'2.4 m/s, eastward and back in turn; nothing is hidden in the first {before}, which the '
        'diagnosis is told are a baseline. Every third of the others is kept back from naming, '
        'and shows what the repair is worth. The plant is not the model: '
        f'{plan.cut}, netting and its ropes with {NORMAL_DRAG:g} times the drag across and '
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
        f'of the plan ({_listed(classes)}). One in {IN_BAGS} of the trials is made as bags too, of '
        'every reading. '
        f'{in_time} trials of a day, of two to four tows of three or four states, with a baseline '
        'or without, were made as windows and towed in time, warps hauled and paid out at '
        f'{HAULING_SPEED:g} m/s; the sizes hidden, plants and instruments are the same for both, '
        'noise and windows are not. Two or three effects at once are each as strong as if alone. '
        'Poor trials have, after the same baseline, three '
        f'tows of one course and one length of warps, and effects of {POOR_STRENGTH:g} times the '
        'smallest detectable size that look alike in such; what they leave open is towed on as '
        'the first proposal has it, and diagnosed again. '
        f'{_drawn(plan)}{len(trials)} trials, of which {len(not_testable)} are not testable, for '
        f'the size would not be possible or the gear could not be towed ({listed}). '
        f'On {os.cpu_count()} cores of {cpu_model()}, with {versions}.'
    )


def _drawn(plan: BlindStudyPlan) -> str:
    """Sentence on a sample; none where all trials are made."""
    if not plan.sample:
        return ''
    number = sum(spec.form == 'windows' for spec in replace(plan, sample=0).specs())
    return f'Of {number} trials {plan.sample} were drawn by chance, before any was made. '


def _listed(classes: Classes) -> str:
    wide = [
        f'{name} or {", ".join(other for other in names if other != name)}'
        for name, names in classes.items()
        if len(names) > 1
    ]
    return ('for ' + '; '.join(wide)) if wide else 'nothing'


SCORINGS = 'scorings.jsonl'


def log_scoring(
    folder: Path, plan: BlindStudyPlan, trials: int, rows: Sequence[MeasuredValue]
) -> None:
    """Add a line: when, of which plan and rules, which targets were asked for, and missed."""
    asked = [row for row in rows if row.target is not None]
    source = Path(rules.__file__).read_bytes()
    line = {
        'time': datetime.now(timezone.utc).isoformat(timespec='seconds'),
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
