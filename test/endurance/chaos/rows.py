"""Rows of the fault injection's report."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence

from endurance.chaos.crew import Recording
from endurance.chaos.kills import Kills
from endurance.chaos.plan import IDENTIFICATION
from endurance.chaos.run import Chaos
from endurance.chaos.tow import DisturbedTow
from trawl_ros.lab.report.measured import MeasuredValue, at_most
from trawl_ros.lab.report.page import Section
from trawl_ros.lab.running.chain import CHAIN
from trawl_ros.records.coefficients import COEFFICIENTS

MOST_LOST_S = 1.0
ENDS = ('', ' low', ' high')
NAMES = tuple(f'{name}{end}' for name in COEFFICIENTS for end in ENDS)
"""Of a coefficient and the ends of its interval in a status."""

YARDSTICK = (
    'A fault may cost windows. That is told, by its reason, and the estimate rests on the others: '
    'it differs from that of the whole tow as any estimate of a part of a tow does, with or '
    'without faults (last row). What is asked for is held against the undisturbed tow in the same '
    'stretches, so that it shows what faults have done to the readings that were used. Noise is '
    'the same in both tows until an instrument is killed; one that is started anew draws noise '
    'and biases anew, and the estimates differ by that.'
)
"""Standard that the estimate is compared with, and the reason."""

MOST_GROWTH = 10.0
"""Memory at the end, per cent above that of the undisturbed tow at its end."""


def chaos_sections(chaos: Chaos) -> list[Section]:
    """Return the rows by their section."""
    wild = chaos.wild
    missing = max(0.0, chaos.plan.end_s - wild.towed_s) / 3600.0
    done = Counter(fault.kind for fault in wild.done)
    listed = ', '.join(f'{kind} {count}' for kind, count in sorted(done.items()))
    cut = [recording for recording in wild.recordings if recording.ended]
    tow = [
        MeasuredValue(
            'tow that is missing to the whole',
            missing,
            'h',
            at_most(0.01 * chaos.plan.hours),
            f'{wild.towed_s / 3600.0:.3g} of {chaos.plan.hours:g} h at sea were towed',
        ),
        MeasuredValue('faults', float(len(wild.done)), note=listed),
        MeasuredValue(
            'nodes ended by themselves',
            float(len(wild.died)),
            target=at_most(0.0),
            note='; '.join(_short(words) for _, words in wild.died),
        ),
        MeasuredValue(
            'full disks that were not told in a sentence',
            float(len(wild.mute)),
            target=at_most(0.0),
            note='; '.join(_short(words) for words in wild.mute),
        ),
        MeasuredValue(
            'longest time without truth',
            wild.silence_s,
            's',
            note=f'wall time; the undisturbed tow: {chaos.calm.silence_s:.1f} s',
        ),
    ]
    return [
        Section('The tow', tow),
        Section('Bags', [*_bags(wild.recordings), *_lost(cut, 'before kills and full disks')]),
        Section('Estimate', _estimate(chaos), text=YARDSTICK),
        Section('Memory', _memory(chaos.calm, wild)),
        Section('The recorder killed at full load', _kills(chaos.kills)),
    ]


def _bags(recordings: Sequence[Recording]) -> list[MeasuredValue]:
    problems = [recording.problem for recording in recordings if recording.problem]
    messages = sum(recording.messages for recording in recordings)
    note = '; '.join(problems) or f'{messages} messages in {len(recordings)} bags'
    return [
        MeasuredValue(
            'bags that cannot be read, repaired',
            float(len(problems)),
            target=at_most(0.0),
            note=note,
        )
    ]


def _lost(cut: Sequence[Recording], what: str) -> list[MeasuredValue]:
    if not cut:
        return []
    lost = [recording.lost_s for recording in cut if not recording.problem]
    note = (
        f'wall time by which the first truth that is not in the bag was heard before, the worst of '
        f'{len(lost)}'
    )
    worst, least = (max(lost), min(lost)) if lost else (math.nan, math.nan)
    return [
        MeasuredValue(f'lost {what}', worst, 's', at_most(MOST_LOST_S), note, low=least, high=worst)
    ]


def _estimate(chaos: Chaos) -> list[MeasuredValue]:
    calm, wild = chaos.calm, chaos.wild
    rejected = {
        key.removeprefix('rejected '): count
        for key, count in wild.estimate.items()
        if key.startswith('rejected ')
    }
    lost = ', '.join(f'{reason} {count}' for reason, count in rejected.items())
    windows = [
        MeasuredValue(
            f'windows of the {title} tow',
            float(tow.estimate.get('windows', 'nan')),
            note=f'{tow.finish}{left_out}',
        )
        for title, tow, left_out in (
            ('undisturbed', calm, ''),
            ('disturbed', wild, f'; left out, as it says: {lost}' if lost else ''),
        )
    ]
    if any(tow.estimate.get('windows', '0') == '0' for tow in (calm, wild)):
        reason = wild.estimate.get('reason', '')
        there = MeasuredValue(
            'estimates without a reason why there is none',
            float(not reason),
            target=at_most(0.0),
            note=reason,
        )
        return [*windows, there]
    whole, disturbed = ({key: float(tow.estimate[key]) for key in NAMES} for tow in (calm, wild))
    return [
        *windows,
        _off(disturbed, chaos.alike, 'estimate off the undisturbed one of the same stretches', 1.0),
        _off(disturbed, whole, 'estimate off that of the whole undisturbed tow'),
        _off(chaos.alike, whole, 'undisturbed estimate of these stretches off that of the whole'),
    ]


def _off(
    estimate: Mapping[str, float], other: Mapping[str, float], what: str, most: float | None = None
) -> MeasuredValue:
    """Compare an estimate, by its own intervals, with another one."""
    unit, target = 'half widths of its 95 % interval', None if most is None else at_most(most)
    if not estimate or not other:
        return MeasuredValue(what, math.nan, unit, target, 'no stretch in common')
    off = {}
    for name in COEFFICIENTS:
        value = other[name]
        middle, low, high = (estimate[f'{name}{end}'] for end in ENDS)
        half = high - middle if value > middle else middle - low
        off[name] = abs(value - middle) / half if half > 0.0 else math.inf * (value != middle)
    worst = max(off, key=lambda name: off[name])
    note = f'the worst of twelve coefficients, {worst}'
    return MeasuredValue(
        what, off[worst], unit, target, note, low=min(off.values()), high=off[worst]
    )


def _memory(calm: DisturbedTow, wild: DisturbedTow) -> list[MeasuredValue]:
    if not calm.glances or not wild.glances:
        return []
    rows = []
    for node in (*CHAIN, IDENTIFICATION):
        before, after = (tow.glances[-1].memory_mb.get(node, math.nan) for tow in (calm, wild))
        note = f'at the end; {before:.0f} MB undisturbed, {after:.0f} MB after chaos'
        growth = 100.0 * (after / before - 1.0)
        rows.append(
            MeasuredValue(
                f'{node}: memory above undisturbed', growth, '%', at_most(MOST_GROWTH), note
            )
        )
    return rows


def _kills(kills: Kills) -> list[MeasuredValue]:
    if not kills.recordings:
        return []
    messages = sum(recording.messages for recording in kills.recordings)
    images = sum(recording.images for recording in kills.recordings)
    return [
        MeasuredValue('kills', float(len(kills.recordings))),
        *_bags(kills.recordings),
        *_lost(kills.recordings, 'before the kill'),
        MeasuredValue(
            'load',
            messages / kills.recorded_s,
            'messages/s',
            note=f'of all topics of the chain, {images} images of the sonar among them',
        ),
    ]


def _short(words: str) -> str:
    """Shorten the last words of a process."""
    lines = [line.strip() for line in words.splitlines()]
    return f'{lines[0].split(";")[0]}: {lines[-1]}'
