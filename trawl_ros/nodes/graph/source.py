# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Source of a subscription: one publisher, recognised by the numbers of its messages.

ROS gives subscribers no name of who has sent a message, but the number that its publisher gave it.
"""

import time
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo


def with_history(profile: QoSProfile) -> QoSProfile:
    """Return the profile of a subscriber that also asks for what was published before it came."""
    asked = copy(profile)
    asked.durability = DurabilityPolicy.TRANSIENT_LOCAL
    return asked


def matching(publishers: Sequence[TopicEndpointInfo], asked: QoSProfile) -> QoSProfile:
    """Lower a subscriber's profile to what all publishers of a topic offer.

    Drivers often offer sensor data as best effort, which a reliable subscriber does not hear.
    """
    heard = copy(asked)
    offers = [publisher.qos_profile for publisher in publishers]
    if any(offer.reliability == ReliabilityPolicy.BEST_EFFORT for offer in offers):
        heard.reliability = ReliabilityPolicy.BEST_EFFORT
    if any(offer.durability == DurabilityPolicy.VOLATILE for offer in offers):
        heard.durability = DurabilityPolicy.VOLATILE
    return heard


def asks_more(asked: QoSProfile, heard: QoSProfile) -> bool:
    """True if a subscriber asks for more than ``heard``, so that a publisher is not heard."""
    return bool(asked.reliability != heard.reliability or asked.durability != heard.durability)


SHORTEST_PATIENCE_S, LONGEST_PATIENCE_S = 2.0, 60.0
PERIODS = 3.0
"""A source that is silent for as many of its periods as this has gone."""

MOST_PUBLISHERS = 8
"""Publishers of one topic that are told apart."""


@dataclass
class _Publisher:
    number: int
    heard_at: float
    period_s: float = 0.0

    def heard(self, number: int, now: float) -> None:
        self.period_s = now - self.heard_at
        self.number, self.heard_at = number, now

    @property
    def patience_s(self) -> float:
        return min(max(PERIODS * self.period_s, SHORTEST_PATIENCE_S), LONGEST_PATIENCE_S)


class Source:
    """Source: the publisher that was heard first, as long as it is heard.

    Two sources of one quantity contradict each other, and a mixture of both is worse than either.
    A node that was killed and started again is the source again from its first message, though the
    middleware has both for some seconds: it bears the name of the other and counts from one.

    Parameters
    ----------
    publishers
        Gives how many publishers are matched just now.
    clock
        Gives wall time in s.
    namesakes
        Gives whether all of them belong to nodes of one name.

    Attributes
    ----------
    lost : int
        Number of the source's messages that have not arrived.
    """

    def __init__(
        self,
        publishers: Callable[[], int],
        clock: Callable[[], float] = time.monotonic,
        namesakes: Callable[[], bool] = lambda: False,
    ) -> None:
        self._publishers = publishers
        self._clock = clock
        self._namesakes = namesakes
        self._source: _Publisher | None = None
        self._others: list[_Publisher] = []
        self.lost = 0

    def take(self, number: int | None) -> bool:
        """True if the message with a number comes from the source.

        Without numbers (None), as with some middleware, no message of several publishers does.
        """
        if number is None:
            return self._publishers() <= 1
        now = self._clock()
        source = self._source
        if source is None:
            self._source = _Publisher(number, now)
            return True
        if number == source.number + 1:
            source.heard(number, now)
            return True
        # Not asked of each message: numbers that follow one another are of one publisher.
        several = self._publishers() > 1
        other = next((twin for twin in self._others if number == twin.number + 1), None)
        if not several and other is None:
            self._go_on(source, number, now)
            return True
        if other is None:
            other = _Publisher(number, now)
            if number < source.number and self._namesakes():
                # Were they twins, the younger one would stay: the other's numbers are higher.
                self._others = [source]
                self._source = other
                return True
            self._others = [*self._others[1 - MOST_PUBLISHERS :], other]
        else:
            other.heard(number, now)
        if several and now - source.heard_at <= source.patience_s:
            return False
        self._source = other
        self._others = [twin for twin in self._others if twin is not other]
        return True

    def _go_on(self, source: _Publisher, number: int, now: float) -> None:
        """Accept a message of the only publisher, after a loss or a restart."""
        if number > source.number:
            self.lost += number - source.number - 1
            source.heard(number, now)
        else:
            self._source = _Publisher(number, now, source.period_s)
        self._others = []
