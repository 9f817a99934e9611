"""Excerpt of a bag that is to be played, repeatedly if wanted."""

from collections.abc import Collection, Iterator

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import BagError
from trawl_ros.core.time import SECOND


class Excerpt:
    """Excerpt: messages of some topics of a bag, from a start to an end.

    Parameters
    ----------
    bag
        The bag.
    topics
        Full names.
    start_s, end_s
        Recorded time since the bag's first message, s; an end of 0 is that of the bag.

    Attributes
    ----------
    upcoming : RawMessage or None
        The next to be played; None at the end.

    Raises
    ------
    BagError
        If there is no message in it.
    """

    def __init__(self, bag: Bag, topics: Collection[str], start_s: float, end_s: float) -> None:
        self._bag = bag
        self._topics = frozenset(topics)
        first = next(bag.as_stored(), None)
        origin = first.log_time if first else 0
        self._start = origin + round(start_s * SECOND)
        self._end = origin + round(end_s * SECOND) if end_s else None
        self._messages: Iterator[RawMessage] = iter(())
        self.upcoming: RawMessage | None = None
        self.begin()

    def begin(self) -> RawMessage:
        """Return to the first message, and give it."""
        self._messages = self._bag.raw(self._topics)
        self.advance()
        while self.upcoming is not None and self.upcoming.log_time < self._start:
            self.advance()
        if self.upcoming is None:
            raise BagError(
                f'{self._bag.path}: no message on the topics to be played between the wanted start '
                'and end; expected an earlier start or a later end'
            )
        return self.upcoming

    def advance(self) -> None:
        """Advance to the next message."""
        following = next(self._messages, None)
        behind = following and self._end is not None and following.log_time > self._end
        self.upcoming = None if behind else following
