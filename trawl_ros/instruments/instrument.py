"""What all instruments have in common: a rate, channels with errors, and a seed."""

from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from trawl_ros.instruments.channel import Channel, ErrorModel
from trawl_ros.instruments.samples import Sample
from trawl_ros.instruments.sampling import SECOND, TOLERANCE, Sampler

PartT = TypeVar('PartT')
SampleT = TypeVar('SampleT', bound=Sample)


@dataclass(frozen=True)
class Draws:
    """What decides on all that is drawn at random.

    ``seed`` is not negative. ``state_changes`` are the times at which biases are drawn anew,
    rising, in seconds since the instrument's first truth. They are given, as a trial's plan
    gives them, and not guessed from the truth: a door sensor cannot see the warps move.
    """

    seed: int = 0
    state_changes: tuple[float, ...] = ()


class Instrument(ABC, Generic[PartT, SampleT]):
    """An instrument looks at its part of the truth and now and then reports a sample.

    It samples on the stamps it is shown, never on a clock. A stamp before the last one (a
    looping bag, a reset simulation) starts it anew, with the readings of a new instrument.

    Parameters
    ----------
    name
        Unique among all instruments: its topic.
    rate
        Samples per second.
    errors
        Errors of each of its channels, by the channel's name.
    draws
        Seed and changes of state.
    """

    def __init__(self, name: str, rate: float, errors: dict[str, ErrorModel], draws: Draws) -> None:
        self.name = name
        self._sampler = Sampler(rate)
        self._channels = {
            channel: Channel(f'{name}/{channel}', model, draws.seed)
            for channel, model in errors.items()
        }
        self._changes: Sequence[int] = [round(t * SECOND) for t in draws.state_changes]
        self._state = 0

    def observe(self, part: PartT, stamp: int) -> SampleT | None:
        """Look at the truth.

        Parameters
        ----------
        part
            What this instrument sees of the truth; the class says what.
        stamp
            Of that truth, ns.

        Returns
        -------
        Sample or None
            A sample with this stamp where one is due.
        """
        if self._sampler.started_anew(stamp):
            for channel in self._channels.values():
                channel.restart()
        if not self._sampler.due(stamp):
            return None
        self._state = bisect_right(self._changes, stamp + TOLERANCE - self._sampler.first)
        return self._read(part, stamp)

    @abstractmethod
    def _read(self, part: PartT, stamp: int) -> SampleT:
        """Make the sample that is due."""

    def _measure(self, channel: str, value: float, stamp: int) -> float:
        return self._channels[channel].measure(value, stamp, self._state)

    def _stated_std(self, channel: str) -> float:
        return self._channels[channel].stated_std
