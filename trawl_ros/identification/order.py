"""Are a channel's stamps to be believed? Late, doubled and leaping ones are told apart.

The verdict on a reading depends on the readings of its own channel alone, so it is the same
however channels interleave.
"""

from collections import Counter
from dataclasses import dataclass, field

from trawl_ros.identification.channels import CHANNELS, INPUTS, Channel, Reading
from trawl_ros.identification.timeline import NANO, Timeline
from trawl_ros.identification.window_records import WindowOptions

BACK_S = 10.0
"""Stamps that go back by more than this (s) are those of a clock set back or a bag that loops."""

CONFIRM = 3
"""Readings in a row that make a leap ahead credible."""

WINCH = CHANNELS[INPUTS[0]].topic

STEP_S = 60.0
"""Longest time (s) between two of these, but for channels that are slower still."""


@dataclass
class Sorted:
    """What came of one reading: readings ``accepted``, and those ``refused`` by reason."""

    accepted: list[Reading] = field(default_factory=list)
    refused: Counter[str] = field(default_factory=Counter)


class Order:
    """Judges the stamps of one channel.

    A reading that leaps ahead of the last by more than the channel's longest gap waits until
    `CONFIRM` readings agree on the new time: one false stamp must neither close windows early
    nor make all that follows look late. After a silence, or a start later than the others',
    readings are refused for half of ``patience_s``: windows may have been decided without the
    channel meanwhile, up to which one depends on how topics interleave, and the estimate must
    not. When the winches were silent too, nothing was decided and nothing is refused.

    Parameters
    ----------
    channel
        The channel's row of the table.
    options
        Slack and patience.
    timeline
        Of the winches, kept by their own readings.

    Attributes
    ----------
    newest
        Newest stamp (ns) that can be believed, None before any.
    """

    def __init__(self, channel: Channel, options: WindowOptions, timeline: Timeline) -> None:
        self.newest: int | None = None
        self._timeline = timeline
        self._winch = channel.topic == WINCH
        self._length = channel.name in INPUTS[:2]
        self._leap = round(channel.longest_gap * NANO)
        self._step = max(round(STEP_S * NANO), self._leap)
        self._reorder = round(options.reorder_s * NANO)
        self._half_patience = round(options.patience_s * NANO) // 2
        self._silence = self._half_patience + round(channel.delay * NANO)
        self._closed_until: int | None = None
        self._waiting: list[Reading] = []

    def judge(self, reading: Reading) -> Sorted:
        """Sort out one reading, and those that have waited for it."""
        found = Sorted()
        if self.newest is None or reading.stamp > self.newest + self._leap:
            self._wait(reading, found)
            return found
        self._give_up(found)
        age = self.newest - reading.stamp
        if age > self._reorder:
            found.refused['clock jump' if age > BACK_S * NANO else 'out of order'] += 1
        else:
            self._accept(reading, found)
        return found

    def finish(self) -> Counter[str]:
        """Refuse what still waits, by reason: nothing will come to confirm it."""
        found = Sorted()
        self._give_up(found)
        return found.refused

    def _wait(self, reading: Reading, found: Sorted) -> None:
        if any(reading.stamp == one.stamp for one in self._waiting):
            found.refused['duplicate stamp'] += 1
            return
        if self._waiting:
            newest = max(one.stamp for one in self._waiting)
            if not newest - self._reorder <= reading.stamp <= newest + self._step:
                self._give_up(found)
        self._waiting.append(reading)
        if len(self._waiting) == CONFIRM:
            waited, self._waiting = self._waiting, []
            for one in sorted(waited, key=lambda one: one.stamp):
                self._accept(one, found)

    def _give_up(self, found: Sorted) -> None:
        if self._waiting:
            found.refused['clock jump'] += len(self._waiting)
            self._waiting = []

    def _accept(self, reading: Reading, found: Sorted) -> None:
        stamp = reading.stamp
        silent = self.newest is None or stamp > self.newest + self._silence
        if silent and not self._winch and self._timeline.speaks_at(stamp - self._half_patience):
            self._closed_until = stamp + self._half_patience
        if self._length:
            self._timeline.advance(stamp)
        self.newest = stamp if self.newest is None else max(self.newest, stamp)
        if self._closed_until is not None and stamp < self._closed_until:
            found.refused['silence'] += 1
        else:
            found.accepted.append(reading)
