# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Scores of answers to blind trials, as rows of a report."""

from collections.abc import Sequence

import numpy as np

from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.lab.missing_effect.calibration import (
    CalibrationOptions,
    Case,
    calibration_error,
    certificates,
    claims,
    likeliest,
    log_score,
    reliability,
    with_probabilities,
)
from trawl_ros.lab.missing_effect.records import (
    AnswerRecord,
    CoefficientsRecord,
    HeldOutRecord,
)
from trawl_ros.lab.report.measured import MeasuredValue, at_most, between
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.report.rates import rate
from trawl_ros.lab.trials.trial import Series

STRENGTH_TARGETS = ((3.0, 80.0, 60.0), (6.0, 92.0, 75.0))
"""Strength; least share (%) of right leaves or nodes, and of right leaves."""

WORSE_SHARE = 0.5
"""Share of the expected error of a channel by which a repair must worsen it to count as worse."""


def all_sections(cases: Sequence[Case], options: CalibrationOptions | None = None) -> list[Section]:
    """Return all sections with their rows."""
    return [
        Section('Names', name_rows(cases)),
        Section('Probabilities', probability_rows(cases, options or CalibrationOptions())),
        Section('Sizes and repairs', size_rows(cases)),
        Section('Each cause', cause_rows(cases)),
    ]


def is_wrong(case: Case) -> bool:
    """Return True if a leaf or node is named that does not hold what is hidden."""
    truth, answer = case
    return any(not truth.holds(path) for path in answer.named)


def is_right(case: Case, *, by_leaf: bool = False) -> bool:
    """Return True if all that is hidden is named, by its leaf or its node, and nothing else."""
    truth, answer = case
    if is_wrong(case) or not answer.named:
        return False
    return all(
        any(cause.has_leaf(path) or (path in cause.nodes and not by_leaf) for path in answer.named)
        for cause in truth.causes
    )


def of_series(cases: Sequence[Case], series: Series) -> list[Case]:
    """Return the cases of a series."""
    return [case for case in cases if case[0].series == series]


def name_rows(cases: Sequence[Case]) -> list[MeasuredValue]:
    """Return how often names are right, wrong or withheld."""
    clean, alone = of_series(cases, 'clean'), of_series(cases, 'alone')
    decided = [case for case in alone if case[1].among]
    rows = [
        rate('clean trials with an alarm', [_is_alarm(answer) for _, answer in clean], most=1.0),
        rate('clean trials with a name', [bool(own.named) for _, own in clean], most=0.0),
        rate('wrong name, of all trials', [is_wrong(case) for case in cases], most=1.0,
             note='; '.join(f'{truth.words} as {" and ".join(answer.named)}'
                            for truth, answer in cases if is_wrong((truth, answer))) or 'none'),
    ]  # fmt: skip
    for strength, least, least_leaf in STRENGTH_TARGETS:
        own = [case for case in alone if case[0].strength == strength]
        rows += [
            rate(f'right leaf, or node of one check, at {strength:g} times',
                 [is_right(case) for case in own], least=least),
            rate(f'right leaf at {strength:g} times',
                 [is_right(case, by_leaf=True) for case in own], least=least_leaf),
        ]  # fmt: skip
    sizes = [len(answer.among) for _, answer in decided]
    return [
        *rows,
        rate('cause within the reported set',
             [any(truth.causes[0].has_leaf(path) for path in answer.among)
              for truth, answer in decided], least=97.0),
        MeasuredValue('median number of leaves in the set', _median(sizes), '', at_most(3.0)),
        rate('outside the library: UNKNOWN, or nothing above 0.5',
             [_is_cautious(case) for case in of_series(cases, 'outside')], least=85.0),
        rate('both of two causes', [is_right(case) for case in of_series(cases, 'pair')],
             least=70.0),
        *(rate(f'{verdict} of one hidden cause', [own.verdict == verdict for _, own in alone])
          for verdict in ('NAMED', 'AMBIGUOUS', 'UNKNOWN', 'NO_DISCREPANCY', 'NOT_TESTABLE')),
    ]  # fmt: skip


def _is_alarm(answer: AnswerRecord) -> bool:
    return answer.verdict not in ('NO_DISCREPANCY', 'NOT_TESTABLE')


def _is_cautious(case: Case) -> bool:
    """Return True if nothing of the library is claimed; probabilities count where there are any."""
    _, answer = case
    if answer.verdict == 'UNKNOWN':
        return True
    own = [answer.of(path) for path in claims(*case) if '/' in path]
    return not answer.named and max(own, default=0.0) < 0.5


def probability_rows(cases: Sequence[Case], options: CalibrationOptions) -> list[MeasuredValue]:
    """Return the reliability of probabilities, and the certificates of cuts."""
    own = with_probabilities(cases)
    found = [likeliest(case) for case in own]
    rows = []
    for part in reliability(found, options):
        low, high = part.interval
        inside = 'inside' if low <= part.mean <= high else 'outside'
        rows.append(
            MeasuredValue(
                f'likeliest claim of probability {part.low:g} to {part.high:g}: right',
                100.0 * part.right / part.number, '%', None,
                f'{part.right} of {part.number}; mean probability {part.mean:.1%}, {inside} the '
                'interval', 100.0 * low, 100.0 * high,
            )
        )  # fmt: skip
    tested = certificates(own, options)
    held = [one.cut for one in tested if one.holds]
    return [
        *rows,
        MeasuredValue('debiased calibration error',
                      calibration_error(found, options) if found else np.nan, '', at_most(0.05)),
        MeasuredValue('mean log probability of what is hidden', log_score(own, options)),
        MeasuredValue('lowest certified cut', held[-1] if held else np.nan, '', None,
                      f'at most {options.most_wrong:.0%} of trials with a wrong name, at '
                      f'{options.confidence:.0%} confidence; the diagnosis uses '
                      f'{InferenceOptions().cut:g}. ' + '; '.join(map(str, tested))),
    ]  # fmt: skip


def size_rows(cases: Sequence[Case]) -> list[MeasuredValue]:
    """Return the coverage of sizes, and the benefit of repairs."""
    covered = [
        size.low <= truth.causes[0].sizes[leaf] <= size.high
        for truth, answer in of_series(cases, 'alone')
        if answer.verdict == 'NAMED'
        for path, size in answer.sizes.items()
        if (leaf := path.rpartition('/')[2]) in truth.causes[0].sizes
    ]
    errors = [
        coefficient_error(own, truth.coefficients)
        for truth, answer in cases
        if (own := answer.coefficients) is not None and is_right((truth, answer))
    ]
    worse = [
        is_worse(answer.held_out, truth.floor)
        for truth, answer in cases
        if answer.held_out is not None and truth.floor
    ]
    seconds = [answer.seconds for _, answer in cases if answer.seconds is not None]
    return [
        rate('sizes within their 95 % interval', covered, least=92.0,
             note='causes of one number in the unit of what is hidden'),
        rate('repairs that worsen a held-out channel more than the plant itself', worse, most=3.0),
        MeasuredValue('error of the coefficients, named rightly over not', _median(errors), '',
                      at_most(0.35)),
        MeasuredValue('processor time of a trial, median', _median(seconds), 's',
                      between(None, 30.0)),
    ]  # fmt: skip


def coefficient_error(own: CoefficientsRecord, truth: Sequence[float]) -> float:
    """Return the distance of the coefficients from the truth with the causes, over that without."""
    after, before = (
        float(np.linalg.norm((np.array(values) - truth) / own.std))
        for values in (own.after, own.before)
    )
    return after / before


def is_worse(own: HeldOutRecord, floor: dict[str, float]) -> bool:
    """Return True if a repair worsens a held-out channel, more than the plant itself."""
    return any(
        own.after[name] > expected
        and own.after[name] - max(own.before[name], floor[name]) > WORSE_SHARE * expected
        for name, expected in own.expected.items()
        if name in floor
    )


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float('nan')


def cause_rows(cases: Sequence[Case]) -> list[MeasuredValue]:
    """Return what was answered of each hidden cause; of one outside the library, with caution."""
    rows = []
    for words in sorted({truth.words for truth, _ in cases if truth.causes}):
        own = [case for case in cases if case[0].words == words]
        said = '; '.join(f'{truth.strength:g} ×: {_said(answer)}' for truth, answer in own)
        right = [
            _is_cautious(case) if case[0].series == 'outside' else is_right(case) for case in own
        ]
        rows.append(rate(f'{words}: right', right, note=said))
    return rows


def _said(answer: AnswerRecord) -> str:
    names = [path.rpartition('/')[2] for path in answer.among[:3]]
    return f'{answer.verdict} {" and ".join(answer.named) or ", ".join(names)}'.strip()
