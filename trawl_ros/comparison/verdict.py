# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Verdict on a comparison in a sentence, and the next step."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.special import chdtrc

from trawl_ros.comparison.summary import ComparedSensor, Summary, Trend
from trawl_ros.core.arrays import BoolArray, FloatArray
from trawl_ros.core.display_units import METRIC, DisplayUnits
from trawl_ros.estimation.fit.error_terms import group_of


@dataclass(frozen=True)
class VerdictOptions:
    """Options of a verdict.

    Attributes
    ----------
    differs
        Std of its error from which a difference counts.
    least_p
        p-value of χ² from which differences are explained.
    named
        Relative difference from which a quantity is named too, once there are some that count.
    most
        Number of quantities that are named.
    """

    differs: float = 3.0
    least_p: float = 0.001
    named: float = 0.02
    most: int = 4


@dataclass(frozen=True)
class Verdict:
    """Verdict on a comparison.

    Attributes
    ----------
    sentence
        What differs, and what would explain it.
    agrees
        True if the known errors explain all differences.
    step
        ``none``, ``identify``, ``diagnose``, or ``compare`` (with the gear).
    suspects
        Channels of sensors to be checked before, because all others agree without them.
    p_values
        Probability of such differences, by explanation: ``errors`` of sensors and operation alone,
        and ``boards`` within the prior of the gear file too.
    """

    sentence: str
    agrees: bool
    step: str
    suspects: tuple[str, ...]
    p_values: Mapping[str, float]

    def next_step(self, logs: str, gear: str) -> str:
        """Return the next step in a sentence; ``logs`` and ``gear`` as on a command line."""
        steps = {
            'none': 'No action is needed.',
            'identify': 'Estimate the door coefficients: '
            f'trawl identify {logs} --gear {gear} --steady --out identified',
            'diagnose': 'Find what the model lacks: '
            f'trawl diagnose {logs} --gear {gear} --out diagnosis',
            'compare': f'Compare each with the gear file: trawl compare {logs} --gear GEAR --out '
            'compared',
        }
        if not self.suspects:
            return steps[self.step]
        words = ' and '.join(map(_name, self.suspects))
        step = steps[self.step]
        return (
            f'Check the readings of {words} first. If they are right: {step[0].lower()}{step[1:]}'
        )


PHRASES: Mapping[str, tuple[str, str, str]] = MappingProxyType(
    {
        'door_spread': ('spread', 'narrower', 'wider'),
        'tension': ('tension', 'lower', 'higher'),
        'door_depth': ('doors', 'shallower', 'deeper'),
        'net_depth': ('net', 'shallower', 'deeper'),
        'vertical_opening': ('opening', 'lower', 'higher'),
        'length': ('warp', 'shorter', 'longer'),
        'speed': ('speed', 'lower', 'higher'),
    }
)
"""Noun, and words for a lower and a higher value, by quantity."""


def verdict_on(
    sensors: Sequence[ComparedSensor],
    summary: Summary,
    than: str,
    units: DisplayUnits = METRIC,
    states: str = 'states',
    options: VerdictOptions | None = None,
) -> Verdict:
    """Judge the differences of all sensors together.

    Differences d have the covariance R of the errors of sensors and operation. Boards with other
    coefficients within the prior P of the gear file add H P Hᵀ, with the derivatives H. An
    explanation holds if the χ² of d under its covariance is probable enough.

    Parameters
    ----------
    sensors, summary
        Sensors, and their means and trends as one vector.
    than
        End of the comparison, such as ``the gear file says``.
    units
        Units of the ends of trends.
    states
        What is averaged over: states, or stretches of time.
    options
        Limits.
    """
    options = options or VerdictOptions()
    errors, boards = summary.covariance, None
    p_values = {'errors': _p_value(summary, errors)}
    if p_values['errors'] >= options.least_p:
        largest = max(sensors, key=lambda sensor: abs(sensor.mean.scaled))
        sentence = (
            f'The log agrees with what {than}: the errors of the sensors explain all differences, '
            f'the largest of which is {_name(largest.channel)} by '
            f'{_size(largest.relative, largest)}.'
        )
        return Verdict(sentence, True, 'none', (), p_values)
    step, told = 'compare', ''
    suspects = _suspects(summary, errors, options)
    if summary.by_coefficients is not None:
        boards = errors + summary.by_coefficients @ summary.by_coefficients.T
        p_values['boards'] = _p_value(summary, boards)
        step, told = 'diagnose', ' Door coefficients alone do not explain this.'
        if p_values['boards'] >= options.least_p:
            step, told = 'identify', ' Other door coefficients would explain all of this.'
    if suspects:
        told = ' All other sensors agree.'
    elif boards is not None and step == 'diagnose':
        suspects = _suspects(summary, boards, options)
        words = ' and '.join(map(_name, suspects))
        told = (
            f' Other door coefficients would explain this, except for {words}.' if words else told
        )
    listed = _differences(sensors, than, states, units, options)
    return Verdict(f'{listed}{told}', False, step, suspects, p_values)


def _p_value(summary: Summary, covariance: FloatArray, kept: BoolArray | None = None) -> float:
    """Return the probability of a larger χ² of the differences, of those ``kept``."""
    kept = np.ones(len(summary.values), dtype=np.bool_) if kept is None else kept
    values, own = summary.values[kept], covariance[np.ix_(kept, kept)]
    std = np.sqrt(np.diag(own))
    scaled = values / std
    square = float(scaled @ np.linalg.solve(own / np.outer(std, std), scaled))
    return float(chdtrc(len(values), max(square, 0.0)))


def _suspects(summary: Summary, covariance: FloatArray, options: VerdictOptions) -> tuple[str, ...]:
    """Return the sensor, or both of a quantity, without which all others agree."""
    names = np.array(summary.channels)
    sensors = {(name,): names != name for name in dict.fromkeys(summary.channels)}
    groups = np.array([group_of(name) for name in summary.channels])
    pairs = {tuple(dict.fromkeys(names[groups == g])): groups != g for g in dict.fromkeys(groups)}
    for trials in (sensors, pairs):
        p_values = {
            left_out: _p_value(summary, covariance, kept)
            for left_out, kept in trials.items()
            if kept.any()
        }
        best = max(p_values, key=p_values.__getitem__, default=())
        if best and p_values[best] >= options.least_p:
            return tuple(map(str, best))
    return ()


def _differences(
    sensors: Sequence[ComparedSensor],
    than: str,
    states: str,
    units: DisplayUnits,
    options: VerdictOptions,
) -> str:
    """Name the quantities that differ, the most significant first."""
    parts: list[tuple[bool, float, str, str]] = []
    by_group: dict[str, list[ComparedSensor]] = {}
    for sensor in sensors:
        by_group.setdefault(group_of(sensor.channel), []).append(sensor)
    for own in by_group.values():
        alike = len(own) == 2 and abs(own[0].relative - own[1].relative) < 0.3 * abs(
            own[0].relative + own[1].relative
        )
        for group in [own] if alike else [[sensor] for sensor in own]:
            scaled = max(abs(sensor.mean.scaled) for sensor in group)
            trend = max((abs(t.scaled) for sensor in group for t in sensor.trends), default=0.0)
            named = not group[0].is_angle and abs(_relative(group)) >= options.named
            by_mean = scaled >= options.differs or named
            where = _where(group[0], states, units, options)
            if by_mean:
                phrase = _phrase(group)
                parts.append((True, scaled, phrase, f'{phrase} than {than}, {where}'))
            elif trend >= options.differs:
                phrase = f'{_noun(group)} differs {where}'
                parts.append((False, trend, phrase, phrase))
    parts.sort(key=lambda part: part[:2], reverse=True)
    if not parts:
        return f'The log differs from what {than}: small differences of many sensors together.'
    others = [phrase for _, _, phrase, _ in parts[1 : options.most]]
    if len(parts) > options.most:
        others.append(f'{len(parts) - options.most} more')
    listed = '; '.join([parts[0][3], *others])
    return f'{listed[0].upper()}{listed[1:]}.'


def _phrase(group: Sequence[ComparedSensor]) -> str:
    _, lower, higher = PHRASES.get(group_of(group[0].channel), ('', 'less', 'more'))
    relative = _relative(group)
    size = f'{abs(math.degrees(relative)):.1f}°' if group[0].is_angle else f'{abs(relative):.1%}'
    size = size.replace('%', ' %')
    return f'{_noun(group)} {size} {lower if relative < 0.0 else higher}'


def _noun(group: Sequence[ComparedSensor]) -> str:
    """Return the noun of a quantity, with its side if the other differs otherwise."""
    channel, quantity = group[0].channel, group_of(group[0].channel)
    noun = PHRASES[quantity][0] if quantity in PHRASES else _name(quantity)
    side = '' if len(group) == 2 else channel.removesuffix(quantity)
    return f'{_name(side)}{noun}'


def _relative(group: Sequence[ComparedSensor]) -> float:
    return float(np.mean([sensor.relative for sensor in group]))


def _where(
    sensor: ComparedSensor, states: str, units: DisplayUnits, options: VerdictOptions
) -> str:
    """Return where a difference is found: everywhere, or along an axis."""
    strong = [trend for trend in sensor.trends if abs(trend.scaled) >= options.differs]
    # A tow often goes from short to long warps, so time is named only where nothing else is.
    trend = max(strong, key=lambda one: (one.axis != 'time', abs(one.scaled)), default=None)
    if trend is not None:
        at = [_size(value, sensor) for value in trend.at_ends]
        low, high = (_place(trend, end, units) for end in trend.ends)
        return f'from {at[0]} {low} to {at[1]} {high}'
    same = np.sign(sensor.fractions) == np.sign(sensor.relative)
    if same.all():
        return f'in all {sensor.states} {states}' if sensor.states > 1 else 'in the only one'
    return f'in {int(same.sum())} of {sensor.states} {states}'


def _place(trend: Trend, end: float, units: DisplayUnits) -> str:
    if trend.axis == 'time':
        return f'{end:.1f} h after the start'
    digits = 0 if trend.axis == 'warp' else 1
    of = 'of warp' if trend.axis == 'warp' else ''
    return f'at {units.shown(end, trend.axis, digits)} {of}'.rstrip()


def _size(value: float, sensor: ComparedSensor) -> str:
    if sensor.is_angle:
        return f'{math.degrees(value):+.1f}°'.replace('-', '−')
    return f'{100.0 * value:+.1f} %'.replace('-', '−')


def _name(channel: str) -> str:
    return channel.replace('_', ' ')
