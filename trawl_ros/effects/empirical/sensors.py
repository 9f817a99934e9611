"""Empirical error terms of single sensors: constant, by value, or by time."""

from collections.abc import Iterator
from dataclasses import dataclass

from trawl_ros.core.arrays import FloatArray
from trawl_ros.effects.base.effect import Readings, Situation
from trawl_ros.effects.base.term import EmpiricalTerm, size
from trawl_ros.records.channels import CHANNELS, MEASURED

READINGS = {
    'offset': 'shows too much throughout',
    'scale': 'has another scale',
    'hours': 'drifts through the tow',
}

EXCITED_BY = {'offset': 'any tow', 'scale': 'what changes the channel', 'hours': 'time in the tow'}


@dataclass(frozen=True)
class SensorError(EmpiricalTerm):
    """Error of one channel: its reading beside the observable."""

    channel: str = ''
    by: str = ''

    def apply_to_sensors(self, values: FloatArray, readings: Readings, at: Situation) -> Readings:
        """Readings with the channel's error."""
        (value,), there = values, readings[self.channel]
        error = {
            'offset': value,
            'scale': value * there,
            'hours': value * at.hours,
        }[self.by]
        return readings | {self.channel: there + error}


def sensor_terms() -> Iterator[EmpiricalTerm]:
    """Yield all sensor terms: three of each channel."""
    for name in MEASURED:
        channel = CHANNELS[name]
        usual = usual_error(name)
        words = name.replace('_', ' ')
        for by, reading in READINGS.items():
            unit, std = ('', 0.05) if by == 'scale' else (channel.unit, usual)
            yield SensorError(
                name=f'empirical_{name}_{by}',
                sentence=f'The sensor of {words} {reading}.',
                parameters=size(unit + (' per h' if by == 'hours' else ''), std, 20.0 * std),
                excited_by=EXCITED_BY[by],
                reading=f'a sensor of {words} that {reading}',
                channel=name,
                by=by,
            )


def usual_error(name: str) -> float:
    """Common error of a channel, a standard deviation, SI; assumed."""
    return 0.05 if CHANNELS[name].unit == 'rad' else 0.02 * _typical(name)


def _typical(name: str) -> float:
    """Typical size of a channel, SI."""
    if name.endswith('tension'):
        return 80e3
    return 50.0 if name in ('door_spread', 'vertical_opening') else 150.0
