"""Watch of a trial over readings: stale and frozen ones, and limits that are reached."""

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from statistics import median

from trawl_ros.control.trial.records import TrialSettings, TrialTarget
from trawl_ros.core.time import SECOND
from trawl_ros.records.channels import Reading, readings
from trawl_ros.records.samples import RangeSample, Sample

NEEDED = ('port_length', 'starboard_length', 'port_tension', 'starboard_tension', 'speed')
"""Channels without which a trial does not begin."""

WATCHED = (*NEEDED, 'port_door_depth', 'starboard_door_depth', 'net_depth', 'heading')
"""Channels that are stale when they fall silent, the others once they have been heard."""

DEPTHS = ('port_door_depth', 'starboard_door_depth', 'net_depth')
LIVELY = ('port_tension', 'starboard_tension', 'speed')
"""Channels whose readings always scatter."""

FROZEN = 12
"""So many readings that are the same to the last digit come of a sensor that is frozen."""

LATE_PERIODS = 1.5
"""A reading is stale when it is older than this many of its usual periods."""

ECHO_SILENCE_S = 60.0
"""An echo of the seabed older than this is not counted on; sooner it may just be lost."""

FOLLOW_M, FOLLOW_SHARE = 5.0, 0.05
"""A counter may lag by so much, and be wrong by this share."""

USUAL = 15
RECENT = 3


@dataclass
class _Channel:
    """Recent readings of a channel: values, stamps, and how late they came (s)."""

    values: deque[float]
    stamps: deque[int]
    lags: deque[float]
    same: int = 1

    @classmethod
    def empty(cls) -> '_Channel':
        return cls(deque(maxlen=RECENT), deque(maxlen=USUAL), deque(maxlen=USUAL))

    def take(self, value: float, stamp: int, now: int) -> None:
        self.same = self.same + 1 if self.values and value == self.values[-1] else 1
        self.values.append(value)
        self.stamps.append(stamp)
        self.lags.append((now - stamp) / SECOND)

    @property
    def value(self) -> float:
        """Median of the last few, which one outlier does not move; NaN before any."""
        return median(self.values) if self.values else math.nan

    def age(self, now: int) -> float:
        """Time (s) since the last reading, less what it usually takes to come."""
        return (now - self.stamps[-1]) / SECOND - max(median(self.lags), 0.0)

    @property
    def period(self) -> float:
        """Usual time (s) between two readings."""
        steps = [(later - earlier) / SECOND for earlier, later in pairwise(self.stamps)]
        return median(steps) if steps else 0.0


class TrialWatch:
    """Watch over the readings of a trial.

    Parameters
    ----------
    settings
        Limits, and when a reading is stale.
    pressure_to_depth
        Depth (m) for an absolute pressure (Pa).
    """

    def __init__(
        self, settings: TrialSettings, pressure_to_depth: Callable[[float], float]
    ) -> None:
        self.settings = settings
        self._pressure_to_depth = pressure_to_depth
        self._channels: dict[str, _Channel] = {}

    def take(self, sample: Sample, now: int) -> None:
        """Take a sample that came at a time (ns)."""
        if isinstance(sample, RangeSample):
            self._take(Reading(sample.what, sample.stamp, sample.distance, 0.0), now)
        for reading in readings(sample, self._pressure_to_depth):
            self._take(reading, now)

    def _take(self, reading: Reading, now: int) -> None:
        if math.isfinite(reading.value):
            channel = self._channels.setdefault(reading.channel, _Channel.empty())
            channel.take(reading.value, reading.stamp, now)

    def value(self, name: str) -> float:
        """Return the recent value of a channel, NaN without one."""
        channel = self._channels.get(name)
        return math.nan if channel is None else channel.value

    def missing(self) -> tuple[str, ...]:
        """Return the needed channels without a reading."""
        return tuple(name for name in NEEDED if name not in self._channels)

    def here(self) -> TrialTarget:
        """Return where counters and log say that the ship is; only if nothing is `missing`."""
        return TrialTarget(
            port=round(self.value('port_length'), 1),
            starboard=round(self.value('starboard_length'), 1),
            speed=round(self.value('speed'), 2),
        )

    def stale(self, now: int) -> tuple[str, ...]:
        """Return what is wrong with readings at a time (ns), in sentences."""
        found = []
        for name in WATCHED:
            channel = self._channels.get(name)
            if channel is None:
                continue
            age = channel.age(now)
            if age > max(self.settings.stale, LATE_PERIODS * channel.period):
                found.append(f'{name} is stale')
            elif name in LIVELY and channel.same >= FROZEN:
                found.append(f'{name} is frozen')
        return tuple(found)

    def not_following(self, wanted: TrialTarget) -> tuple[str, ...]:
        """Return which winches are not where they are wanted, in sentences."""
        lengths = (('port', wanted.port), ('starboard', wanted.starboard))
        return tuple(
            f'{side} winch does not follow'
            for side, length in lengths
            if abs(self.value(f'{side}_length') - length) > FOLLOW_M + FOLLOW_SHARE * length
        )

    def water_depth(self, now: int) -> float:
        """Return the depth (m) of the water: by the sounder, else as set; infinite without."""
        echo = self._echo('depth', now)
        return self.settings.seabed if math.isnan(echo) else min(echo, self.settings.seabed)

    def limits(self, now: int) -> tuple[str, ...]:
        """Return the limits that are reached, in sentences."""
        settings, found = self.settings, []
        for side in ('port', 'starboard'):
            if self.value(f'{side}_tension') > settings.max_tension:
                found.append(f'tension of the {side} warp above {settings.max_tension / 1e3:g} kN')
        depths = [self.value(name) for name in DEPTHS if name in self._channels]
        deepest = max(depths, default=0.0)
        if deepest > settings.max_depth:
            found.append(f'gear below {settings.max_depth:g} m')
        opening = self.value('opening_height')
        above = self._echo('bottom', now) - (0.0 if math.isnan(opening) else opening)
        distance = min((self.water_depth(now) - deepest, above), key=_nan_last)
        if distance < settings.clearance:
            found.append(f'gear less than {settings.clearance:g} m above the seabed')
        # A gear is not straight behind a ship that turns faster than she is told to.
        if abs(self.value('yaw_rate')) > 2.0 * settings.max_turn:
            found.append(f'ship turns faster than {math.degrees(2 * settings.max_turn):.2f} deg/s')
        return tuple(found)

    def haul_share(self) -> float:
        """Return the share of the winches' speed that the tension leaves for hauling."""
        most = self.settings.max_tension
        if math.isinf(most):
            return 1.0
        tension = max(self.value('port_tension'), self.value('starboard_tension'))
        return min(max(10.0 * (1.0 - tension / most), 0.1), 1.0)

    def _echo(self, name: str, now: int) -> float:
        channel = self._channels.get(name)
        if channel is None or channel.age(now) > ECHO_SILENCE_S:
            return math.nan
        return channel.value


def _nan_last(value: float) -> float:
    return math.inf if math.isnan(value) else value
