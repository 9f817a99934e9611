# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Checks of instrument readings: possible values, one source, and streams that begin again."""

from collections import defaultdict
from typing import Any

from trawl_ros.bags.one_source import SourceWatch
from trawl_ros.core.errors import MessageError
from trawl_ros.core.stamps import CONFIRMING_READINGS
from trawl_ros.core.time import SECOND
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.records.possible import impossible
from trawl_ros.records.samples import Sample, WinchSample

BACK_NS = 10 * SECOND
"""Stamps that go back by more than this (ns) belong to a new run; by less, to a late message."""

MOST_HELD = 2000
"""Samples held back at most: what all instruments say in some ten seconds."""


class Rewinding:
    """Detector of a rewound stream, such as a bag that loops; single false stamps do not count.

    The winch gives the time, since without it there are no windows. What goes back is held until
    three of its readings in a row do, or one does not: forgetting all for one false stamp
    would be worse than to refuse the reading, and what the new round begins with is not to be
    lost. A sensor whose own clock is set back is no new round.

    Parameters
    ----------
    newest
        Newest stamp (ns) of the winch, where it is known from before.
    """

    def __init__(self, newest: int | None = None) -> None:
        self._newest = newest
        self._held: list[Sample] = []
        self._leaps: list[int] = []

    def forget(self) -> None:
        """Reset; the next sample is the beginning."""
        self._newest, self._held, self._leaps = None, [], []

    def take(self, sample: Sample) -> tuple[bool, list[Sample]]:
        """Filter the next sample.

        Returns
        -------
        bool
            True if the stream begins again before these samples.
        list of Sample
            Samples to deal with now, in order of arrival.
        """
        before, stamp = self._newest, sample.stamp
        back = before is not None and stamp < before - BACK_NS
        if back:
            self._held.append(sample)
        if isinstance(sample, WinchSample):
            leaps = before is not None and abs(stamp - before) > BACK_NS
            if leaps and not self._confirmed(stamp):
                return False, [] if back else [sample]
            self._newest = stamp if leaps or before is None else max(stamp, before)
            held, self._held, self._leaps = self._held, [], []
            return back, held if back else [*held, sample]
        if not back:
            return False, [sample]
        return False, [self._held.pop(0)] if len(self._held) > MOST_HELD else []

    def _confirmed(self, stamp: int) -> bool:
        """True if enough readings of the winch have leapt to about here."""
        self._leaps = [leap for leap in self._leaps if abs(stamp - leap) <= BACK_NS]
        self._leaps.append(stamp)
        return len(self._leaps) >= CONFIRMING_READINGS


class Reached:
    """Newest stamp (ns) so far, 0 before any; single ones far ahead do not count."""

    def __init__(self, stamp: int = 0) -> None:
        self.stamp = stamp
        self._ahead = 0

    def take(self, stamp: int) -> int:
        """Register the next stamp, and return the newest."""
        leaps = self.stamp > 0 and stamp > self.stamp + BACK_NS
        self._ahead = self._ahead + 1 if leaps else 0
        if not leaps or self._ahead >= CONFIRMING_READINGS:
            self.stamp = max(stamp, self.stamp)
        return self.stamp


def possible_sample(topic: str, message: Any) -> Sample:
    """Turn the message of an instrument topic into a sample.

    Raises
    ------
    MessageError
        If it contradicts the topic, or has a value that cannot be: one such would stay in all
        that is carried on from sample to sample.
    """
    sample = to_sample(topic, message)
    if reason := impossible(sample):
        raise MessageError(f'{topic}: {reason}')
    return sample


class OneSourceEach:
    """Check that each instrument topic of a node has one source.

    Two publishers are told apart by the numbers of their messages; what a player or a bridge
    passes on comes from one, and is recognised by its stamps and values.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Reset, as for a stream that begins again."""
        self._watches: defaultdict[str, SourceWatch] = defaultdict(SourceWatch)

    def check(self, topic: str, sample: Sample) -> None:
        """Register a reading of a topic.

        Raises
        ------
        MessageError
            If those so far are of two sources, or their clock gives no time.
        """
        if doubt := self._watches[topic].take(0, sample):
            raise MessageError(f'{topic} {doubt.text}; it is not used')
