"""The catalogue of bad input: each has its reason and its sentence, and does no harm.

A coarse gear is solved once at each state of the tow, with its sensitivities; between these
the model is linear, in the tests' data and in the estimator alike.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from trawl_ros.estimation.pipeline import Identification
from trawl_ros.estimation.windows.records import WindowOptions
from trawl_ros.records.observables import OBSERVABLES
from trawl_ros.records.samples import (
    AttitudeSample,
    HeadingSample,
    PressureSample,
    RangeSample,
    Sample,
    VelocitySample,
    WinchSample,
)

SECOND = 1_000_000_000
Samples = Sequence[Sample]
FEET, KNOTS, DEGREES = 3.28084, 1.943844, 57.29578


def door(sample: Sample, side: str = 'port') -> bool:
    return isinstance(sample, PressureSample) and sample.place == side


def spread(sample: Sample) -> bool:
    return isinstance(sample, RangeSample) and sample.what == 'spread'


def log(sample: Sample) -> bool:
    return isinstance(sample, VelocitySample) and sample.over == 'water'


def winch(sample: Sample) -> bool:
    return isinstance(sample, WinchSample)


def tilt(sample: Sample) -> bool:
    return isinstance(sample, AttitudeSample) and sample.side == 'port'


def second(sample: Sample, samples: Samples) -> int:
    return (sample.stamp - samples[0].stamp) // SECOND


def each(
    which: Callable[[Sample], bool], when: Callable[[int], bool], **changes: object
) -> Callable[[Samples], Samples]:
    """Change what is chosen: by a value, or a function of the old one."""

    def corrupt(samples: Samples) -> Samples:
        def changed(sample: Sample) -> Sample:
            if not (which(sample) and when(second(sample, samples))):
                return sample
            values = {
                name: change(getattr(sample, name)) if callable(change) else change
                for name, change in changes.items()
            }
            return replace(sample, **values)

        return [changed(sample) for sample in samples]

    return corrupt


def drop(
    which: Callable[[Sample], bool], when: Callable[[int], bool]
) -> Callable[[Samples], Samples]:
    return lambda samples: [
        sample for sample in samples if not (which(sample) and when(second(sample, samples)))
    ]


def always(_: int) -> bool:
    return True


def times(factor: float) -> Callable[[float], float]:
    return lambda value: value * factor


def both(factor: float) -> Callable[[tuple[float, float]], tuple[float, float]]:
    return lambda pair: (pair[0] * factor, pair[1] * factor)


def deeper(factor: float) -> Callable[[float], float]:
    return lambda pressure: 101_325.0 + (pressure - 101_325.0) * factor


def delayed(which: Callable[[Sample], bool], seconds: float) -> Callable[[Samples], Samples]:
    """The samples chosen arrive later than they should."""

    def corrupt(samples: Samples) -> Samples:
        arrival = [s.stamp + seconds * SECOND * which(s) for s in samples]
        return [samples[i] for i in np.argsort(arrival, kind='stable')]

    return corrupt


def every(seconds: int, lateness: float) -> Callable[[Samples], Samples]:
    """Now and then a reading of the doors' pressure overtakes others."""

    def corrupt(samples: Samples) -> Samples:
        late = [door(s) and second(s, samples) % seconds == 0 for s in samples]
        arrival = [s.stamp + lateness * SECOND * is_late for s, is_late in zip(samples, late)]
        return [samples[i] for i in np.argsort(arrival, kind='stable')]

    return corrupt


def moved(seconds: float, since: int) -> Callable[[Samples], Samples]:
    """All clocks are set."""
    return lambda samples: [
        replace(s, stamp=s.stamp + round(seconds * SECOND)) if second(s, samples) >= since else s
        for s in samples
    ]


@dataclass(frozen=True)
class Case:
    """``what`` is done, the ``reason`` that is to be counted, and words of its sentence."""

    what: str
    done: Callable[[Samples], Samples]
    reason: str
    words: str = ''


def some(seconds: int) -> Callable[[int], bool]:
    return lambda second: second % seconds == 0


def burst(second: int) -> bool:
    return second % 40 < 3


def after(seconds: int) -> Callable[[int], bool]:
    return lambda second: second >= seconds


def speed(change: Callable[[float], float]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda velocity: np.array([change(velocity[0]), 0.0, 0.0])


def stamp_by(seconds: float) -> Callable[[int], int]:
    return lambda stamp: stamp + round(seconds * SECOND)


DAY = 86_400.0

CATALOGUE = (
    Case('NaN', each(door, some(7), pressure=math.nan), 'not finite', 'port_door_depth'),
    Case('infinite', each(spread, some(5), distance=math.inf), 'not finite', 'inf'),
    Case('beyond the range', each(spread, some(6), distance=700.0), 'out of range', 'door_spread'),
    Case('half of them beyond the range',
        each(spread, some(2), distance=700.0), 'out of range', 'expected 5 to'),
    Case('frozen depth', each(door, always, pressure=1.2e6), 'frozen', 'port_door_depth'),
    Case('frozen in mid-tow', each(tilt, after(250), pitch=0.1), 'frozen', 'port_pitch'),
    Case('frozen log',
        each(log, always, velocity=np.array([2.1, 0.0, 0.0])), 'frozen', 'velocity_water'),
    Case('bursts', each(door, burst, pressure=lambda p: p + 3e5), 'outlier', 'port_door_depth'),
    Case('spikes all over', each(winch, some(4), tensions=both(3.0)), 'outlier', 'tension'),
    Case('spikes of the log', each(log, some(9), velocity=speed(times(2.5))), 'outlier', 'speed'),
    Case('warps in feet', each(winch, always, lengths=both(FEET)), 'wrong unit', 'like feet'),
    Case('warps in fathoms',
        each(winch, always, lengths=both(0.546807)), 'wrong unit', 'like fathoms'),
    Case('spread in feet', each(spread, always, distance=times(FEET)), 'wrong unit', 'like feet'),
    Case('a door in feet', each(door, always, pressure=deeper(FEET)), 'wrong unit', 'like feet'),
    Case('net depth in feet',
        each(lambda s: door(s, 'sonar'), always, pressure=deeper(FEET)), 'wrong unit', 'like feet'),
    Case('opening in feet',
        each(
            lambda s: isinstance(s, RangeSample) and s.what == 'opening_height',
            always, distance=times(FEET),
        ),
        'wrong unit', 'like feet'),
    Case('knots', each(log, always, velocity=speed(times(KNOTS))), 'wrong unit', 'knots'),
    Case('kilometres per hour',
        each(log, always, velocity=speed(times(3.6))), 'wrong unit', 'kilometres per hour'),
    Case('kN', each(winch, always, tensions=both(1e-3)), 'wrong unit', 'kilonewtons'),
    Case('tonnes', each(winch, always, tensions=both(1 / 9806.65)), 'wrong unit', 'tonnes-force'),
    Case('pitch in degrees', each(tilt, always, pitch=times(DEGREES)), 'wrong unit', 'degrees'),
    Case('roll in degrees', each(tilt, always, roll=times(DEGREES)), 'wrong unit', 'degrees'),
    Case('heading in degrees',
        each(lambda s: isinstance(s, HeadingSample), always, heading=lambda h: h % 6.28 * DEGREES),
        'out of range', 'heading'),
    Case('tension fourfold', each(winch, always, tensions=both(4.0)), 'implausible', 'contradict'),
    Case('roll upside down', each(tilt, always, roll=lambda r: 1.4), 'frozen', 'port_roll'),
    Case('gap', drop(door, lambda t: 110 < t < 215), 'gap', 'port_door_depth'),
    Case('silence', drop(door, lambda t: 150 < t < 215), 'silence', 'port_door_depth'),
    Case('late', delayed(spread, 150.0), 'late', 'door_spread'),
    Case('out of order', every(11, 5.5), 'out of order', 'port_door_depth'),
    Case('twice',
        lambda samples: [s for s in samples for _ in range(2)], 'duplicate stamp', 'twice'),
    Case('stamp that stands still',
        each(door, always, stamp=1), 'duplicate stamp', 'port_door_depth'),
    Case('a stamp of tomorrow', each(winch, some(97), stamp=stamp_by(DAY)), 'clock jump', 'ahead'),
    Case('a stamp of yesterday', each(log, some(97), stamp=stamp_by(-DAY)), 'clock jump', 'before'),
    Case('clock set back', moved(-7200.0, 420), 'clock jump', 'before'),
    Case('clock set ahead by minutes', moved(300.0, 420), 'gap', 'silent'),
    Case('clock set ahead by hours', moved(7200.0, 420), 'gap', 'silent'),
    Case('a bag that loops', lambda samples: [*samples, *samples], 'clock jump', 'before'),
    Case('a channel that dies', drop(spread, after(300)), 'gap', 'door_spread'),
    Case('an optional channel that dies', drop(tilt, after(300)), 'gap', 'door/port/attitude'),
    Case('a channel that never comes', drop(spread, always), 'missing channel', 'spread'),
)  # fmt: skip

OPTIONS = WindowOptions(settle_s=120.0, settle_passages=0.0)
HARMLESS = 0.3


def identify(tow, samples):
    identification = Identification(tow.linear, tow.prior, OBSERVABLES, tow.depth, OPTIONS)
    for sample in samples:
        identification.feed(sample)
    identification.finish()
    return identification


def used(identification):
    return [item.window for item in identification.course]


@pytest.fixture(scope='module')
def clean(clean_tow):
    return identify(clean_tow, clean_tow.samples)


def test_the_clean_tow_gives_all_states_and_no_complaint(clean):
    assert [window.state for window in used(clean)] == [0, 1, 2]
    assert set(clean.rejected) <= {'unsteady', 'turning', 'outlier'}
    # Of some thousand readings of 14 channels.
    assert clean.rejected.get('outlier', 0) <= 2
    assert all(window.track is not None for window in used(clean))


def std_moved(found, clean):
    """By how much the estimate was moved, in its standard deviations."""
    return np.max(np.abs(found.estimate.values - clean.estimate.values) / clean.estimate.std)


def only_refused(found, clean):
    """Whether what is in the estimate is as it was, and less of it, or in a tow of its own."""
    names, tows = 0, set()
    for window in used(found):
        (before,) = [
            other for other in used(clean)
            if abs(other.means['port_length'] - window.means['port_length']) < 5.0
            and abs(other.means['speed'] - window.means['speed']) < 0.1
        ]  # fmt: skip
        for name, mean in window.means.items():
            if abs(mean - before.means[name]) > HARMLESS * before.std(name):
                return False
        names += len(window.means)
        tows.add(window.tow)
    return names < sum(len(window.means) for window in used(clean)) or len(tows) > 1


@pytest.mark.parametrize('case', CATALOGUE, ids=lambda case: case.what)
def test_bad_input_is_counted_said_and_does_no_harm(clean_tow, clean, case):
    found = identify(clean_tow, case.done(clean_tow.samples))
    assert found.rejected[case.reason] > 0
    assert case.words in found.found[case.reason]
    refused = found.estimate is None or only_refused(found, clean)
    assert refused or std_moved(found, clean) < HARMLESS
