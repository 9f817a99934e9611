"""Rows of the study of onsets."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from studies.onset.trial import BEHIND_MIN, OnsetTrial
from trawl_ros.core.arrays import FloatArray
from trawl_ros.diagnosis.onset.monitor import OnsetOptions
from trawl_ros.lab.report.measured import MeasuredValue, TargetRange, at_most
from trawl_ros.lab.report.page import TextTable
from trawl_ros.lab.report.rates import AGAIN, figure_row, rate

NEAR_S = 180.0
"""An onset is right that is told within so much."""

FALLEN_S = 60.0
"""Boards that lie for so much of a tow are none that a ship would tow on with: she would haul."""

ASKED_H = 230.0
"""Hours of clean tows in which one false finding is allowed."""


def onset_rows(made: Sequence[OnsetTrial]) -> list[MeasuredValue]:
    """Rows of the trials that could be made."""
    limit = OnsetOptions().limit
    hidden = [trial for trial in made if trial.effect]
    found = [trial for trial in hidden if trial.raised_s is not None]
    delays = np.array([_delay(trial) / 60.0 for trial in found])
    right = [abs(_late(trial)) <= NEAR_S for trial in found]
    named = [trial.effect == trial.name or trial.effect in trial.alike for trial in found]
    half_s = 0.5 * 60.0 * BEHIND_MIN
    upright = [trial for trial in made if trial.fallen_s < FALLEN_S]
    upright_hidden = [trial.raised_s is not None for trial in upright if trial.effect]
    standing = f'of tows in which boards lie for less than {FALLEN_S:g} s'
    return [
        rate(
            'effects that are detected',
            [trial.raised_s is not None for trial in hidden],
            least=95.0,
        ),
        rate(
            f'the same, of tows judged for half of the {BEHIND_MIN:g} min behind its beginning',
            [trial.raised_s is not None for trial in hidden if trial.behind_s >= half_s],
        ),
        rate(f'the same, {standing}', upright_hidden),
        _quantile('delay, median', delays, 0.5, 5.0, 'delay_median'),
        _quantile('delay, 90 %', delays, 0.9, 15.0, 'delay_90'),
        rate('onsets within 3 min, of those detected', right, least=80.0),
        rate('the right effect is named, or listed as similar, of those detected', named),
        _false('false findings in 230 h', made, at_most(1.0), 'false_230_h'),
        _false(f'false findings in 230 h {standing}', upright, key='false_230_h_upright'),
        *_rarest(made, limit),
        _judged('of the tows that is judged', made, 'judged'),
        _judged(f'of these, {standing}', upright, 'judged_upright'),
        _core(made),
    ]


def trials_table(made: Sequence[OnsetTrial]) -> TextTable:
    """Table of the trials with an effect."""
    return TextTable(
        'Trials with an effect',
        ('trial', 'effect', 'size', 'began, min', 'judged behind, min', 'boards lie, min',
         'raised after, min', 'onset off by, min', 'name', 'not told from'),
        tuple(_row(trial) for trial in made if trial.effect),
    )  # fmt: skip


def reasons_table(made: Sequence[OnsetTrial]) -> TextTable:
    """Table of the reasons for which nothing was judged."""
    towed = sum(trial.watched_s + trial.unwatched_s for trial in made)
    reasons = {why for trial in made for why in trial.reasons}
    spent = {why: sum(trial.reasons.get(why, 0.0) for trial in made) for why in reasons}
    rows = sorted(spent.items(), key=lambda row: -row[1])
    return TextTable(
        'Why nothing was judged',
        ('reason', 'of the time, %'),
        tuple((why, f'{100.0 * own / towed:.1f}') for why, own in rows),
    )


def known_words(made: Sequence[OnsetTrial]) -> str:
    """Sentence on what the boards were known by."""
    by = Counter(trial.known for trial in made).most_common()
    told = ', '.join(f'{what} in {number}' for what, number in by)
    return f'Boards were known by {told} of {len(made)} tows.'


def _delay(trial: OnsetTrial) -> float:
    assert trial.raised_s is not None
    assert trial.begin_s is not None
    return trial.raised_s - trial.begin_s


def _late(trial: OnsetTrial) -> float:
    assert trial.onset_s is not None
    assert trial.begin_s is not None
    return trial.onset_s - trial.begin_s


def _quantile(what: str, delays: FloatArray, part: float, most: float, key: str) -> MeasuredValue:
    if not len(delays):
        return MeasuredValue(what, np.nan, 'min', at_most(most), 'nothing was detected', key=key)
    row = figure_row(
        what,
        lambda some: float(np.quantile(delays[some], part)),
        len(delays),
        'min',
        at_most(most),
        f'of {len(delays)} that were detected; {AGAIN}',
    )
    return replace(row, key=key)


def _false(
    what: str, made: Sequence[OnsetTrial], target: TargetRange | None = None, key: str = ''
) -> MeasuredValue:
    """False findings per 230 h of what was judged before anything began."""
    hours = sum(trial.clean_s for trial in made) / 3600.0
    count = sum(trial.false for trial in made)
    low = 0.5 * chi2.ppf(0.025, 2 * count) if count else 0.0
    high = 0.5 * chi2.ppf(0.975, 2 * count + 2)
    part = ASKED_H / hours if hours else np.nan
    note = f'{count} in {hours:.1f} h; 95 % interval of a Poisson rate'
    return MeasuredValue(
        what, count * part, '', target, note, float(low * part), float(high * part), key
    )


def _rarest(made: Sequence[OnsetTrial], limit: float) -> list[MeasuredValue]:
    clean = [trial.rarity for trial in made if not trial.effect]
    if not clean:
        return []
    what = f'largest rarity in {len(clean)} clean tows'
    note = f'-log10; findings are raised beyond {limit:g}'
    return [MeasuredValue(what, max(clean), '', at_most(limit), note, key='rarest_clean')]


def _judged(what: str, made: Sequence[OnsetTrial], key: str) -> MeasuredValue:
    """Part of the tows in which innovations were judged."""
    judged = sum(trial.watched_s for trial in made)
    towed = sum(trial.watched_s + trial.unwatched_s for trial in made)
    part = 100.0 * judged / towed if towed else np.nan
    idle = sum(trial.unwatched_s > 0.5 * (trial.watched_s + trial.unwatched_s) for trial in made)
    note = f'of {towed / 3600.0:.1f} h; less than half in {idle} of {len(made)} tows'
    return MeasuredValue(what, part, '%', note=note, key=key)


def _core(made: Sequence[OnsetTrial]) -> MeasuredValue:
    seconds = sum(trial.seconds for trial in made)
    towed = sum(trial.watched_s + trial.unwatched_s for trial in made)
    part = 100.0 * seconds / towed if towed else np.nan
    note = 'processor time of the monitor over the time towed; net of 12 meshes around'
    return MeasuredValue('of a core in real time', part, '%', at_most(15.0), note, key='core')


def _row(trial: OnsetTrial) -> tuple[str, ...]:
    assert trial.begin_s is not None
    head = (
        str(trial.number), trial.effect, f'{trial.size:.3g}', f'{trial.begin_s / 60.0:.1f}',
        f'{trial.behind_s / 60.0:.1f}', f'{trial.fallen_s / 60.0:.1f}',
    )  # fmt: skip
    if trial.raised_s is None:
        return *head, 'not detected', '', '', ''
    return (
        *head, f'{_delay(trial) / 60.0:.1f}', f'{_late(trial) / 60.0:.1f}', trial.name,
        ', '.join(trial.alike),
    )  # fmt: skip
