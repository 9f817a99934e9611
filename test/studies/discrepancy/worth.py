"""Worth of a repair where the effect was named rightly."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from studies.rates import median, rate
from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.trials.trial import Scored
from trawl_ros.lab.trials.verdicts import (
    Classes,
    chosen,
    hidden_names,
    named_right,
    said_of,
)
from trawl_ros.records.coefficients import COEFFICIENTS

BENT = 3.0
"""Standard deviations by which leaving an effect out bends a coefficient that counts."""

WORSE_BY = 0.5
"""Part of the error that instruments explain, by which a repair is not to be worse."""

HALF, SIGMAS = 0.5, 1.96
"""A quantity is worse where the readings want less than this part of what a repair changes, with so
many standard deviations."""


def repair_rows(trials: Sequence[Scored], classes: Classes) -> list[MeasuredValue]:
    """Gain by the named effect on held-out tows."""
    named = [
        trial
        for trial in chosen(trials, 'inside')
        if trial.key['spec']['strength'] >= 3.0 and named_right(trial, classes)
    ]
    repaired = [
        trial
        for trial in trials
        if trial.diagnosis is not None and trial.diagnosis['verdict'] == 'NAMED'
    ]
    removed, placebo = (
        [100.0 * part for trial in named if (part := _removed(trial, by)) is not None]
        for by in ('after', 'placebo')
    )
    bent = [trial for trial in named if _bent(trial) >= BENT]
    truth = [_coefficient_ratio(trial, _truth(trial)) for trial in bent]
    quiet = [trial for trial in named if trial.quiet is not None]
    nearest = [_coefficient_ratio(trial, _quiet(trial)['coefficients']) for trial in quiet]
    hidden = [_hidden_covered(trial) for trial in named]
    best = [covered for trial in quiet for covered in _best_covered(trial)]
    return [
        median('held-out excess error removed by the effect that is named', removed, '%',
               least=80.0),
        median('held-out excess error removed by the best wrong effect', placebo, '%',
               most=20.0),
        rate('repairs that make a channel worse on what was kept back',
             [_worse(trial) for trial in repaired], most=2.0,
             note=f'of all that were named; by {WORSE_BY:.0%} of what instruments explain or more'),
        rate('the plant itself, by the same count',
             [worse for trial in repaired if (worse := _plant_worse(trial)) is not None],
             note='the right gear with the right effect: what calibration of the tows kept back '
             'makes of it'),
        rate('repairs that make a channel worse, and worse than the plant itself does',
             [worse for trial in repaired if (worse := _worse_than_plant(trial)) is not None],
             note=f'both by {WORSE_BY:.0%} of what instruments explain or more'),
        rate('repairs of which readings kept back want less than half, in any quantity',
             [_unwanted(trial) for trial in repaired],
             note='beyond the 95 % interval of that part: calibration of the tows kept back, which '
             'the counts above take for an error of the repair, is in it'),
        median(f'error of the coefficients with the effect named over that without, where leaving '
               f'it out bends one by {BENT:g} std or more', _known(truth), '', most=0.4),
        median('the same from what readings without errors are best fitted with',
               _known(nearest), ''),
        rate('amplitude intervals that cover the best fit to readings without errors', best,
             least=90.0, most=98.0, note='all parameters of effects named rightly at 3 times'),
        rate('amplitude intervals that cover the hidden size',
             [value for value in hidden if value is not None],
             note='effects of one parameter whose unit is that of the size'),
    ]  # fmt: skip


def _known(values: Sequence[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _quiet(trial: Scored) -> dict[str, Any]:
    assert trial.quiet is not None
    return trial.quiet


def _truth(trial: Scored) -> Mapping[str, float]:
    return dict(zip(COEFFICIENTS, trial.key['coefficients'], strict=True))


def _removed(trial: Scored, by: str) -> float | None:
    channels = said_of(trial)['channels']
    if any(channel[by] is None for channel in channels.values()):
        return None
    before, after, expected = (
        {name: channel[key] for name, channel in channels.items()}
        for key in ('before', by, 'expected')
    )
    return part_removed(before, after, expected, trial.key['floor'])


def part_removed(
    before: Mapping[str, float],
    after: Mapping[str, float],
    expected: Mapping[str, float],
    floor: Mapping[str, float],
) -> float | None:
    """Share of the mean square error beyond that of the plant itself which a repair removes.

    Parameters
    ----------
    before, after, expected, floor
        Errors by channel: without and with it, those of instruments, in which all are counted, and
        those of the plant.

    Returns
    -------
    float or None
        None where nothing is beyond, or a channel's floor is not known.
    """
    if not set(before) <= set(floor):
        return None
    was, left = (
        sum((errors[name] ** 2 - floor[name] ** 2) / expected[name] ** 2 for name in before)
        for errors in (before, after)
    )
    return 1.0 - left / was if was > 0.0 else None


def _coefficient_ratio(trial: Scored, truth: Mapping[str, float]) -> float | None:
    """Error of the coefficients with the effect over that without, each in its posterior std."""
    found = said_of(trial)['coefficients']
    sums = {'before': 0.0, 'after': 0.0}
    for name, value in truth.items():
        own = found[name]
        if own['after'] is None:
            return None
        for when in sums:
            sums[when] += ((own[when]['value'] - value) / own['after']['std']) ** 2
    return float(np.sqrt(sums['after'] / sums['before']))


def _bent(trial: Scored) -> float:
    """Standard deviations by which the coefficient that is bent most changes with the effect."""
    found = said_of(trial)['coefficients'].values()
    return max(
        (
            abs(own['before']['value'] - own['after']['value']) / own['after']['std']
            for own in found
            if own['after'] is not None
        ),
        default=0.0,
    )


def _worse(trial: Scored) -> bool:
    """True if a channel's error is larger with the repair, beyond what instruments explain."""
    return any(
        is_worse(own['before'], own['after'], own['expected'])
        for own in said_of(trial)['channels'].values()
        if own['after'] is not None
    )


def _unwanted(trial: Scored) -> bool:
    """True if the readings that were kept back want less than half of a quantity's change."""
    return any(
        own['part_std'] is not None and own['part'] + SIGMAS * own['part_std'] < HALF
        for own in said_of(trial).get('held_out', {}).values()
    )


def _plant_worse(trial: Scored) -> bool | None:
    """True if a channel's error is so much larger with the plant itself; None where not known."""
    channels, floor = said_of(trial)['channels'], trial.key['floor']
    if not set(channels) <= set(floor):
        return None
    return any(
        is_worse(own['before'], floor[name], own['expected']) for name, own in channels.items()
    )


def _worse_than_plant(trial: Scored) -> bool | None:
    """True if a channel's error is so much larger with the repair than before, and than the
    plant's; None where that is not known.
    """
    channels, floor = said_of(trial)['channels'], trial.key['floor']
    if not set(channels) <= set(floor):
        return None
    return any(
        is_worse(max(own['before'], floor[name]), own['after'], own['expected'])
        for name, own in channels.items()
        if own['after'] is not None
    )


def is_worse(before: float, after: float, expected: float) -> bool:
    """True if an error is larger than instruments explain, by `WORSE_BY` of that than before."""
    return after > expected and after - before > WORSE_BY * expected


def _best_covered(trial: Scored) -> list[bool]:
    """Coverage of the best fit to readings without errors by each interval."""
    name = hidden_names(trial)[0]
    own = [effect for effect in said_of(trial)['effects'] if effect['name'] == name]
    return [
        bool(interval['low'] <= _quiet(trial)['parameters'][parameter] <= interval['high'])
        for effect in own
        for parameter, interval in effect['parameters'].items()
    ]


def _hidden_covered(trial: Scored) -> bool | None:
    """True if the interval of an effect of one parameter covers the hidden size."""
    effects, name = said_of(trial)['effects'], hidden_names(trial)[0]
    if len(effects) != 1 or effects[0]['name'] != name or len(effects[0]['parameters']) != 1:
        return None
    ((_, parameter),) = effects[0]['parameters'].items()
    neutral = 1.0 if name == 'warp_strumming' else 0.0
    size = trial.key['sizes'][0] + neutral
    return bool(parameter['low'] <= size <= parameter['high'])
