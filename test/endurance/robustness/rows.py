"""Outcomes of changed gears and of hours of random commands, as rows of a table."""

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from endurance.robustness.changed_values import tow_outcome
from endurance.robustness.random_commands import commanded_hour
from trawl_ros.core.arrays import FloatArray
from trawl_ros.gear.records import GearRecord
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.rates import rate
from trawl_ros.model.gear_model import build_model


@dataclass(frozen=True)
class Outcome:
    """Outcome of a tow in a word and a sentence, CPU time (s), and of an hour of commands the time
    with a fallen board (s) and whether one lay at the end.
    """

    name: str
    outcome: str
    sentence: str
    seconds: float
    fallen_s: float = 0.0
    fallen_at_end: bool = False


def changed_gear(gear: GearRecord, key: str, factor: float, length: float) -> Outcome:
    """Tow a gear with one number multiplied."""
    began = time.process_time()
    outcome, sentence = tow_outcome(gear, key, factor, length)
    name = f'{key} * {factor:g} at {length:g} m'
    return Outcome(name, outcome, sentence, time.process_time() - began)


def random_hour(gear: GearRecord, seed: int, points: FloatArray | None = None) -> Outcome:
    """Tow an hour of random commands, if wanted with other fastening points (3, 3), m."""
    began, model = time.process_time(), build_model(gear)
    hour = commanded_hour(model if points is None else model.with_board(points=points), seed)
    return Outcome(
        f'hour {seed}',
        'failed' if hour.failure else 'towed',
        hour.failure,
        time.process_time() - began,
        hour.fallen_s,
        hour.fallen_at_end,
    )


def value_rows(tows: Sequence[Outcome]) -> list[MeasuredValue]:
    """Rows of changed gears."""
    counts = Counter(tow.outcome for tow in tows)
    words = ', '.join(f'{number} {outcome}' for outcome, number in counts.most_common())
    return [
        MeasuredValue(
            'changed gears without steady state or physical reason',
            counts['none found'],
            target=at_most(0.0),
            note=f'Of {len(tows)}: {words}.',
        ),
        MeasuredValue(
            'longest CPU time of an answer', max(tow.seconds for tow in tows), 's', at_most(2.0)
        ),
    ]


def hour_rows(hours: Sequence[Outcome]) -> list[MeasuredValue]:
    """Rows of hours of random commands."""
    failed = [hour for hour in hours if hour.outcome == 'failed']
    fell = [hour for hour in hours if hour.fallen_s]
    lying = [hour for hour in fell if hour.fallen_at_end and hour.outcome == 'towed']
    cost = sum(hour.seconds for hour in hours) / len(hours)
    return [
        MeasuredValue('hours of random commands', len(hours), note=f'{cost:.1f} s of CPU each'),
        MeasuredValue(
            'hours that ended before their time',
            len(failed),
            target=at_most(0.0),
            note='; '.join(f'{hour.name}: {hour.sentence}' for hour in failed[:5]),
        ),
        rate(
            'share of hours that ended before their time',
            [hour.outcome == 'failed' for hour in hours],
        ),
        MeasuredValue('hours in which a board fell', len(fell), note='And the tow went on.'),
        MeasuredValue(
            'median time with a fallen board', float(np.median([h.fallen_s for h in hours])), 's'
        ),
        MeasuredValue('hours after which a board lay still', len(lying)),
    ]
