# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Timestamp check of a channel: late, duplicate and leaping stamps are told apart.

The verdict on a reading depends on the readings of its own channel alone, so it is the same
however channels interleave.
"""

from trawl_ros.core.stamps import CONFIRMING_READINGS
from trawl_ros.estimation.windows.records import Rejections, WindowOptions
from trawl_ros.estimation.windows.watermark import NANO, Watermark
from trawl_ros.records.channels import CHANNELS, INPUTS, Channel, Reading

BACK_S = 10.0
"""Stamps that go back by more than this (s) are those of a clock set back or a bag that loops."""

WINCH = CHANNELS[INPUTS[0]].topic

STEP_S = 60.0
"""Longest time (s) between two of these, but for channels that are slower still."""


class TimestampCheck:
    """Timestamp check of one channel.

    A reading that leaps ahead of the last by more than the channel's longest gap waits until
    three readings agree on the new time: one false stamp must neither close windows early
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
    watermark
        Of the winches, kept by their own readings.
    rejections
        Counts of refused readings.

    Attributes
    ----------
    newest
        Newest stamp (ns) that can be believed, None before any.
    """

    def __init__(
        self,
        channel: Channel,
        options: WindowOptions,
        watermark: Watermark,
        rejections: Rejections,
    ) -> None:
        self.newest: int | None = None
        self._where = f'{channel.name} ({channel.topic})'
        self._rejections = rejections
        self._winch_watermark = watermark
        self._winch = channel.topic == WINCH
        self._length = channel.name in INPUTS[:2]
        self._leap = round(channel.longest_gap * NANO)
        self._step = max(round(STEP_S * NANO), self._leap)
        self._reorder = round(options.reorder_s * NANO)
        self._half_patience = round(options.patience_s * NANO) // 2
        self._silence = self._half_patience + round(channel.delay * NANO)
        self._closed_until: int | None = None
        self._waiting: list[Reading] = []

    def judge(self, reading: Reading) -> list[Reading]:
        """Return the readings that are accepted now, this one or those that waited for it."""
        if self.newest is None or reading.stamp > self.newest + self._leap:
            return self._wait(reading)
        if self._waiting:
            self.give_up()
        behind = self.newest - reading.stamp
        if behind <= self._reorder:
            return self._accept([reading])
        reason = 'clock jump' if behind > BACK_S * NANO else 'out of order'
        sentence = f'{self._where} is stamped {behind / NANO:.1f} s before what came earlier'
        self._rejections.add(reason, sentence)
        return []

    def give_up(self) -> None:
        """Reject the waiting readings: nothing has come to confirm them."""
        if not self._waiting:
            return
        leap = f'{self._where} is stamped far from its other readings, and only for a moment'
        if self.newest is not None:
            ahead = (self._waiting[0].stamp - self.newest) / NANO
            leap = f'{self._where} is stamped {ahead:.1f} s ahead for a moment'
        self._rejections.add('clock jump', leap, len(self._waiting))
        self._waiting = []

    def _wait(self, reading: Reading) -> list[Reading]:
        if any(reading.stamp == waiting.stamp for waiting in self._waiting):
            self._rejections.add('duplicate stamp', f'{self._where} has a stamp twice')
            return []
        if self._waiting:
            newest = max(waiting.stamp for waiting in self._waiting)
            if not newest - self._reorder <= reading.stamp <= newest + self._step:
                self.give_up()
        self._waiting.append(reading)
        if len(self._waiting) < CONFIRMING_READINGS:
            return []
        waited, self._waiting = self._waiting, []
        return self._accept(sorted(waited, key=lambda waiting: waiting.stamp))

    def _accept(self, readings: list[Reading]) -> list[Reading]:
        accepted = []
        for reading in readings:
            stamp = reading.stamp
            silent = self.newest is None or stamp > self.newest + self._silence
            if (
                silent
                and not self._winch
                and self._winch_watermark.speaks_at(stamp - self._half_patience)
            ):
                self._closed_until = stamp + self._half_patience
            if self._length:
                self._winch_watermark.advance(stamp)
            self.newest = stamp if self.newest is None else max(self.newest, stamp)
            if self._closed_until is None or stamp >= self._closed_until:
                accepted.append(reading)
                continue
            wait = self._half_patience / NANO
            sentence = f'{self._where} was silent for long and is not used for {wait:g} s'
            self._rejections.add('silence', sentence)
        return accepted
