"""Figures of the blind trials."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import binomtest

from studies.discrepancy.calibration import (
    calibration_error,
    certified_cut,
    claim,
    of_truth,
)
from studies.discrepancy.trial import BlindTrial
from studies.rates import rate
from trawl_ros.diagnosis.inference.options import InferenceOptions
from trawl_ros.lab.report.measured import MeasuredValue, at_least, at_most, between
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.trials.answers import holds, right_leaves, right_nodes

TOP_BINS = ((0.0, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 0.95), (0.95, 0.99), (0.99, 1.01))


def all_sections(trials: Sequence[BlindTrial]) -> list[Section]:
    """Return all sections with their rows."""
    tested = [trial for trial in trials if trial.verdict]
    return [
        Section('Names', name_rows(tested)),
        Section('Probabilities', probability_rows(tested)),
        Section('Sizes and repairs', size_rows(tested)),
        Section('Each cause', cause_rows(tested)),
    ]


def is_wrong(trial: BlindTrial) -> bool:
    """Return True if a leaf or node is named that does not hold what is hidden."""
    return any(not holds(path, trial.effects) for path in trial.named)


def is_right(trial: BlindTrial) -> bool:
    """Return True if all that is hidden is named, by its leaf or its node, and nothing else."""
    if is_wrong(trial) or not trial.named:
        return False
    return all(
        any(
            path in right_nodes(cause) or path.rpartition('/')[2] in right_leaves(cause)
            for path in trial.named
        )
        for cause in trial.effects
    )


def _by_leaf(trial: BlindTrial) -> bool:
    return is_right(trial) and all(
        any(path.rpartition('/')[2] in right_leaves(cause) for path in trial.named)
        for cause in trial.effects
    )


def name_rows(trials: Sequence[BlindTrial]) -> list[MeasuredValue]:
    """Return how often names are right, wrong or withheld."""
    clean = [own for own in trials if own.series == 'clean']
    outside = [own for own in trials if own.series == 'outside']
    pairs = [own for own in trials if own.series == 'pair']
    alone = [own for own in trials if own.series == 'alone']
    decided = [own for own in alone if own.among]
    sets = [len(own.among) for own in decided]
    first = [own for own in alone if own.leaves]
    rows = [
        rate('clean trials with an alarm',
             [own.verdict not in ('NO_DISCREPANCY', 'NOT_TESTABLE') for own in clean], most=1.0),
        rate('clean trials with a name', [own.verdict == 'NAMED' for own in clean], most=0.0),
        rate('wrong name, of all trials', [is_wrong(own) for own in trials], most=1.0,
             note=', '.join(f'{"+".join(own.effects) or "nothing"} as {" and ".join(own.named)}'
                            for own in trials if is_wrong(own)) or 'none'),
    ]  # fmt: skip
    for strength, least, leaf in ((3.0, 80.0, 60.0), (6.0, 92.0, 75.0)):
        own = [trial for trial in alone if trial.strength == strength]
        rows += [
            rate(f'right leaf, or node of one check, at {strength:g} times',
                 [is_right(trial) for trial in own], least=least),
            rate(f'right leaf at {strength:g} times', [_by_leaf(trial) for trial in own],
                 least=leaf),
        ]  # fmt: skip
    return [
        *rows,
        rate('right leaf the likeliest',
             [next(iter(own.leaves or {})) in right_leaves(own.effects[0]) for own in first]),
        rate('right leaf within the reported set',
             [bool(set(own.among) & set(right_leaves(own.effects[0]))) for own in decided],
             least=97.0),
        MeasuredValue('median number of leaves in the set',
                      float(np.median(sets)) if sets else np.nan, '', at_most(3.0)),
        rate('outside the library at 6 times: UNKNOWN, or nothing above 0.5',
             [own.verdict == 'UNKNOWN' or max((own.nodes or {'': 0.0}).values(), default=0.0) < 0.5
              for own in outside], least=85.0),
        rate('both of two causes', [is_right(own) for own in pairs], least=70.0),
        *(rate(f'{verdict} of what is hidden', [own.verdict == verdict for own in alone])
          for verdict in ('NAMED', 'AMBIGUOUS', 'UNKNOWN', 'NO_DISCREPANCY', 'NOT_TESTABLE')),
    ]  # fmt: skip


def probability_rows(trials: Sequence[BlindTrial]) -> list[MeasuredValue]:
    """Return the reliability of probabilities, and the certificate of the cut."""
    options = InferenceOptions()
    own = [trial for trial in trials if trial.explanations]
    claims = [claim(trial, options.temperature) for trial in own]
    rows = []
    for low, high in TOP_BINS:
        some = [one for one in claims if low <= one.probability < high]
        if not some:
            continue
        right, said = sum(one.right for one in some), np.mean([one.probability for one in some])
        ends = binomtest(right, len(some)).proportion_ci(method='exact')
        rows.append(
            MeasuredValue(
                f'likeliest claim of probability {low:g} to {min(high, 1.0):g}: right',
                100.0 * right / len(some), '%', None,
                f'{right} of {len(some)}, where {said:.1%} were said; '
                f'{"inside" if ends.low <= said <= ends.high else "outside"} the interval',
                100.0 * ends.low, 100.0 * ends.high,
            )
        )  # fmt: skip
    cut = certified_cut(own, options.temperature)
    return [
        *rows,
        MeasuredValue('debiased calibration error', calibration_error(claims), '', at_most(0.05)),
        MeasuredValue('mean log probability of what is hidden',
                      float(np.mean([np.log(max(of_truth(one, options.temperature), 1e-6))
                                     for one in own])), ''),
        MeasuredValue('lowest cut certified on these trials', np.nan if cut is None else cut, '',
                      None, f'the cut in use is {options.cut:g}, the temperature '
                      f'{options.temperature:g}'),
    ]  # fmt: skip


def size_rows(trials: Sequence[BlindTrial]) -> list[MeasuredValue]:
    """Return what sizes and repairs are worth."""
    covered = []
    for own in trials:
        if own.series != 'alone' or own.verdict != 'NAMED' or not own.values:
            continue
        for name, (_, low, high) in own.values.items():
            neutral = 1.0 if name == 'warp_strumming' else 0.0
            same_unit = name == own.effects[0] or name in KEYS_AS_HIDDEN
            if name in right_leaves(own.effects[0]) and same_unit:
                covered.append(low <= own.sizes[0] + neutral <= high)
    errors = [own.coefficient_error for own in trials
              if own.coefficient_error is not None and is_right(own)]  # fmt: skip
    removed = [own.removed for own in trials if own.removed is not None and is_right(own)]
    seconds = [own.seconds for own in trials]
    return [
        rate('sizes within their 95 % interval', covered, least=92.0,
             note='causes of one number in the unit of what is hidden'),
        rate('repairs that worsen a held-out channel more than the plant itself',
             [own.worse for own in trials if own.worse is not None], most=3.0),
        MeasuredValue('error of the coefficients, named rightly over not', _median(errors), '',
                      at_most(0.35)),
        MeasuredValue('excess error on held-out tows that is removed', 100.0 * _median(removed),
                      '%', at_least(80.0)),
        MeasuredValue('time of a diagnosis, median', _median(seconds), 's', between(None, 30.0)),
    ]  # fmt: skip


KEYS_AS_HIDDEN = ('board_area', 'footrope_weight', 'headrope_length', 'kite_weight', 'front_twine',
                  'board_mass', 'warp_diameter', 'twine', 'warp_hole_ahead')  # fmt: skip
"""Changes of the gear file that are hidden in this very form."""


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if values else float('nan')


def cause_rows(trials: Sequence[BlindTrial]) -> list[MeasuredValue]:
    """Return what was said of each hidden cause."""
    rows = []
    for cause in sorted({'+'.join(own.effects) for own in trials if own.effects}):
        some = [own for own in trials if '+'.join(own.effects) == cause]
        said = '; '.join(
            f'{own.strength:g} ×: {own.verdict} '
            f'{" and ".join(own.named) or ", ".join(list(own.leaves or {})[:3])}'
            for own in some
        )
        rows.append(rate(f'{cause}: right', [is_right(own) for own in some], note=said))
    return rows
