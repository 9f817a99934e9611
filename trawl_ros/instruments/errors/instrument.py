# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Base class of instruments: sampling clock, channels with errors, faults, and a seed."""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from trawl_ros.core.time import SECOND
from trawl_ros.instruments.errors.channel import ErrorChannel, ErrorModel
from trawl_ros.instruments.errors.faults import OF_INSTRUMENTS, Fault
from trawl_ros.instruments.errors.random_processes import (
    NO_BURSTS,
    SECONDS_PER_HOUR,
    BurstModel,
    Bursts,
    generator,
)
from trawl_ros.instruments.errors.timing import Timing

PartT = TypeVar('PartT')
SampleT = TypeVar('SampleT')

STAMP_TOLERANCE_NS = 1_000
"""Bound of the rounding error of stamps that were made from seconds in floating point."""

MAX_JITTER_FRACTION = 0.45
"""Greatest jitter as a fraction of the period; samples keep their order below one half."""

DROPOUT_S = 10.0
"""Mean length of the bursts of a fault 'dropouts'."""


@dataclass(frozen=True)
class SeedPlan:
    """Seed plan of an instrument's random numbers.

    ``seed`` is not negative. ``state_changes`` are the rising times at which biases are drawn
    again, in seconds since the instrument's first truth. The plan of a trial gives them; they
    cannot follow from the truth, because a door sensor does not see the warps move.
    """

    seed: int = 0
    state_changes: tuple[float, ...] = ()


class Sampler:
    """Sampler: decides at which stamps a sample is due.

    It uses the stamps of the truth only, so that results do not depend on the machine. The first
    stamp is due, then each multiple of the period since, at the first stamp that reaches it. So
    the mean rate is right for any pace of the truth. If the truth is slower than the sensor, each
    stamp is due.

    Parameters
    ----------
    rate
        Samples per second.
    start_up
        Time (s) after the first stamp in which nothing is due.
    """

    def __init__(self, rate: float, start_up: float = 0.0) -> None:
        self._rate = rate
        self._start_up = round(start_up * SECOND)
        self._first = 0
        self._latest: int | None = None
        self._next = 0

    @property
    def first(self) -> int:
        """Stamp of the first truth (ns)."""
        return self._first

    def restarted(self, stamp: int) -> bool:
        """Register a stamp (ns); return True if it is the first or precedes the last one."""
        restarts = self._latest is None or stamp < self._latest
        self._latest = stamp
        if restarts:
            self._first = stamp
            self._next = 0
        return restarts

    def due(self, stamp: int, shift_s: float = 0.0) -> bool:
        """Return True if a sample is due at ``stamp`` (ns), which `restarted` has registered.

        ``shift_s`` is the delay of the next sample after its regular time, s.
        """
        since = stamp + STAMP_TOLERANCE_NS - self._first - self._start_up
        most = MAX_JITTER_FRACTION / self._rate
        shift = round(min(max(shift_s, -most), most) * SECOND)
        if since < round(self._next * SECOND / self._rate) + shift or since < 0:
            return False
        self._next = max(self._next + 1, int((since - shift) * self._rate / SECOND) + 1)
        return True


class SamplingClock:
    """Sampling clock of an instrument: times of sampling and sending, with timing faults.

    Parameters
    ----------
    name
        Name of the instrument.
    timing
        Timing without faults.
    seed
        Seed that all instruments share.
    """

    def __init__(self, name: str, timing: Timing, seed: int) -> None:
        self._name = name
        self._timing = timing
        self._seed = seed
        self._sampler = Sampler(timing.rate, timing.start_up)
        self._faults: dict[str, float] = {}
        self._shift = 0.0
        self._restart()

    @property
    def first(self) -> int:
        """Stamp of the first truth (ns)."""
        return self._sampler.first

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Active faults of the timing."""
        return tuple(Fault(kind, size) for kind, size in self._faults.items())

    @property
    def latency_s(self) -> float:
        """Time from sampling to sending, s."""
        return self._timing.latency + self._faults.get('late', 0.0)

    def put(self, fault: Fault) -> None:
        """Activate a fault."""
        self._faults[fault.kind] = fault.size
        if fault.kind == 'dropouts':
            share = fault.size
            rate = SECONDS_PER_HOUR * share / (DROPOUT_S * (1.0 - share))
            drawn = generator(self._seed, f'{self._name}/fault')
            self._faulty = Bursts(BurstModel(rate, DROPOUT_S), drawn)

    def take_off(self, kind: str) -> None:
        """Deactivate one kind of fault."""
        self._faults.pop(kind, None)
        if kind == 'dropouts':
            self._faulty = Bursts(NO_BURSTS, generator(self._seed, f'{self._name}/fault'))

    def clear(self) -> None:
        """Deactivate all faults."""
        for kind in list(self._faults):
            self.take_off(kind)

    def restarted(self, stamp: int) -> bool:
        """Register a stamp (ns); return True if it is the first or precedes the last one."""
        restarts = self._sampler.restarted(stamp)
        if restarts:
            self._restart()
        return restarts

    def due(self, stamp: int) -> bool:
        """Return True if a sample is due at a stamp (ns), which `restarted` has registered."""
        size = self._timing.jitter + self._faults.get('jitter', 0.0)
        if not self._sampler.due(stamp, size * self._shift if size else 0.0):
            return False
        self._shift = self._drawn_shift()
        return True

    def sends(self, stamp: int) -> bool:
        """Return True if a sample taken at a stamp (ns) is sent."""
        # Each process is advanced at each stamp, so that they do not depend on each other.
        dropped, faulty = self._dropouts.on(stamp), self._faulty.on(stamp)
        missed = self._timing.missed > 0.0 and self._missed.random() < self._timing.missed
        return not (dropped or faulty or missed or 'silent' in self._faults)

    def _drawn_shift(self) -> float:
        return float(self._jitter.standard_normal())

    def _restart(self) -> None:
        self._jitter = generator(self._seed, f'{self._name}/jitter')
        self._missed = generator(self._seed, f'{self._name}/missed')
        self._shift = self._drawn_shift()
        dropouts = generator(self._seed, f'{self._name}/dropouts')
        self._dropouts = Bursts(self._timing.dropouts, dropouts)
        share = self._faults.pop('dropouts', None)
        self._faulty = Bursts(NO_BURSTS, generator(self._seed, f'{self._name}/fault'))
        if share is not None:
            self.put(Fault('dropouts', share))


class Instrument(ABC, Generic[PartT, SampleT]):
    """Instrument: observes its part of the truth and reports samples at its rate.

    It samples by the stamps of the truth, never by a clock. A stamp before the last one (a looping
    bag, a reset simulation) restarts it: readings are those of a new instrument, faults stay
    active.

    Parameters
    ----------
    name
        Its topic, unique among all instruments.
    timing
        Timing of sampling and sending.
    errors
        Error model of each channel, by the channel's name.
    draws
        Seed and changes of state.
    """

    def __init__(
        self, name: str, timing: Timing, errors: dict[str, ErrorModel], draws: SeedPlan
    ) -> None:
        self.name = name
        self._beat = SamplingClock(name, timing, draws.seed)
        self._channels = {
            channel: ErrorChannel(f'{name}/{channel}', model, draws.seed)
            for channel, model in errors.items()
        }
        self._changes: Sequence[int] = [round(t * SECOND) for t in draws.state_changes]
        self._state = 0
        self._under_way: deque[tuple[int, SampleT]] = deque()

    @property
    def quantities(self) -> tuple[str, ...]:
        """Names of the measured quantities."""
        return tuple(self._channels)

    def put(self, fault: Fault, quantity: str | None = None) -> None:
        """Activate a fault, on one quantity or, without it, on the whole instrument."""
        if fault.kind in OF_INSTRUMENTS:
            self._beat.put(fault)
        else:
            for channel in self._chosen(quantity):
                channel.put(fault)

    def take_off(self, kind: str, quantity: str | None = None) -> None:
        """Deactivate one kind of fault."""
        if kind in OF_INSTRUMENTS:
            self._beat.take_off(kind)
        else:
            for channel in self._chosen(quantity):
                channel.take_off(kind)

    def clear(self, quantity: str | None = None) -> None:
        """Deactivate all faults of a quantity, or all there are."""
        if quantity is None:
            self._beat.clear()
        for channel in self._chosen(quantity):
            channel.clear()

    def faults(self) -> dict[str, tuple[Fault, ...]]:
        """Return the active faults by topic or topic/quantity."""
        alone = len(self._channels) == 1
        found = {self.name: self._beat.faults}
        for channel in self._channels.values():
            place = self.name if alone else channel.name
            found[place] = found.get(place, ()) + channel.faults
        return {place: on for place, on in found.items() if on}

    def observe(self, part: PartT, stamp: int) -> list[SampleT]:
        """Observe the truth; return the samples that arrive.

        Parameters
        ----------
        part
            Part of the truth that this instrument sees, of the type of its class.
        stamp
            Stamp of that truth, ns.

        Returns
        -------
        list of Sample
            Samples that arrive now. A latency makes them samples of earlier stamps.
        """
        if self._beat.restarted(stamp):
            self._under_way.clear()
            for channel in self._channels.values():
                channel.restart()
            self._restart()
        if self._beat.due(stamp):
            self._state = bisect_right(self._changes, stamp + STAMP_TOLERANCE_NS - self._beat.first)
            sample = self._read(part, stamp)
            if sample is not None and self._beat.sends(stamp):
                at = stamp + round(self._beat.latency_s * SECOND)
                self._under_way.append((at, sample))
        arrived = []
        while self._under_way and self._under_way[0][0] <= stamp + STAMP_TOLERANCE_NS:
            arrived.append(self._under_way.popleft()[1])
        return arrived

    @abstractmethod
    def _read(self, part: PartT, stamp: int) -> SampleT | None:
        """Return the sample that is due; None if nothing can be measured."""

    def _restart(self) -> None:
        """Reset the state of a subclass; channels are reset already."""

    def _measure(self, channel: str, value: float, stamp: int) -> float:
        return self._channels[channel].measure(value, stamp, self._state)

    def _stated_std(self, channel: str) -> float:
        return self._channels[channel].stated_std

    def _chosen(self, quantity: str | None) -> list[ErrorChannel]:
        return list(self._channels.values()) if quantity is None else [self._channels[quantity]]
