"""Moments of a bag: the messages nearest to chosen times."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.time import SECOND
from trawl_ros.plots.records import TowHistory
from trawl_ros.records.topics import absolute

GEAR, MOUTH, POSE = 'truth/gear', 'truth/net/mouth', 'truth/sonar/pose'
SECTION, IMAGE, SCAN = 'truth/sonar/section', 'sonar/image', 'sonar/scan'
MOST_AWAY_S = {GEAR: 10.0, MOUTH: 10.0, POSE: 10.0, SECTION: 10.0, IMAGE: 120.0, SCAN: 120.0}
"""Largest distance from a chosen time at which a message is drawn for it."""


@dataclass(frozen=True)
class Moment:
    """Moment: the messages nearest to ``time`` (s), by topic."""

    time: float
    messages: Mapping[str, Any]


def read_moments(
    path: Path, tow: TowHistory, times: Sequence[float], namespace: str, topics: Iterable[str]
) -> Iterator[Moment]:
    """Yield the messages nearest to each of the times (s, rising).

    Of each topic no more messages are kept than there are times, and each is decoded only when
    its turn comes.
    """
    bag = Bag(path, namespace=namespace)
    names = {absolute(topic, namespace): topic for topic in topics}
    wanted = [tow.stamp(time) + tow.log_lag for time in times]
    nearest: list[dict[str, RawMessage]] = [{} for _ in wanted]
    last: dict[str, RawMessage] = {}
    done = dict.fromkeys(names.values(), 0)
    for raw in bag.raw(names):
        topic = names[raw.topic]
        while done[topic] < len(wanted) and wanted[done[topic]] <= raw.log_time:
            k = done[topic]
            before = last.get(topic, raw)
            nearer = wanted[k] - before.log_time < raw.log_time - wanted[k]
            nearest[k][topic] = before if nearer else raw
            done[topic] += 1
        last[topic] = raw
    for topic, raw in last.items():
        for k in range(done[topic], len(wanted)):
            nearest[k][topic] = raw
    for time, stamp, messages in zip(times, wanted, nearest, strict=True):
        yield Moment(time, _decoded(bag, messages, stamp))


def _decoded(bag: Bag, nearest: Mapping[str, RawMessage], wanted: int) -> dict[str, Any]:
    messages = {}
    for topic, raw in nearest.items():
        if abs(raw.log_time - wanted) <= MOST_AWAY_S[topic] * SECOND:
            messages[topic] = bag.decode(raw)
    return messages


def corners(moment: Moment) -> FloatArray:
    """Corners (2 N, 3) of the mouth in ``map``: headrope from port, footrope back."""
    points = moment.messages[MOUTH].polygon.points
    return np.array([[point.x, point.y, point.z] for point in points], dtype=float)
