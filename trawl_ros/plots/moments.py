"""What a bag holds nearest to chosen times: the gear, the mouth, a sweep of the sonar."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from trawl_ros.bags.reader import Bag, RawMessage
from trawl_ros.errors import MessageError
from trawl_ros.instruments.samples import SonarImageSample, SonarScanSample
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.messages.stamps import SECOND
from trawl_ros.messages.topics import absolute
from trawl_ros.plots.records import SonarPicture, Tow

GEAR, MOUTH, POSE = 'truth/gear', 'truth/net/mouth', 'truth/sonar/pose'
SECTION, IMAGE, SCAN = 'truth/sonar/section', 'sonar/image', 'sonar/scan'
TOPICS = (GEAR, MOUTH, POSE, SECTION, IMAGE, SCAN)

MOST_AWAY_S = {GEAR: 10.0, MOUTH: 10.0, POSE: 10.0, SECTION: 10.0, IMAGE: 120.0, SCAN: 120.0}
"""What is further from a chosen time is not drawn for it."""

READING_AWAY_S = 60.0
"""A reading of the opening belongs to a sweep that is not further away."""


@dataclass(frozen=True)
class Moment:
    """The messages nearest to ``time`` (s), by topic of `TOPICS`."""

    time: float
    messages: Mapping[str, Any]


def read_moments(
    path: Path, tow: Tow, times: Sequence[float], namespace: str, topics: Iterable[str] = TOPICS
) -> Iterator[Moment]:
    """Find what is nearest to each of the times (s, rising).

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
    for time, stamp, found in zip(times, wanted, nearest, strict=True):
        yield Moment(time, _decoded(bag, found, stamp))


def _decoded(bag: Bag, found: Mapping[str, RawMessage], wanted: int) -> dict[str, Any]:
    messages = {}
    for topic, raw in found.items():
        if abs(raw.log_time - wanted) <= MOST_AWAY_S[topic] * SECOND:
            messages[topic] = bag.decode(raw)
    return messages


def sonar_picture(moment: Moment, tow: Tow) -> SonarPicture | None:
    """The sweep nearest to a moment; None where there is none.

    Raises
    ------
    MessageError
        If no scan says at which angles the image's beams look.
    """
    if IMAGE not in moment.messages:
        return None
    image = to_sample(IMAGE, moment.messages[IMAGE])
    assert isinstance(image, SonarImageSample)
    time = tow.time(image.stamp)
    scan = to_sample(SCAN, moment.messages[SCAN]) if SCAN in moment.messages else None
    if (
        not isinstance(scan, SonarScanSample)
        or scan.stamp != image.stamp
        or len(scan.ranges) != len(image.image)
    ):
        raise MessageError(
            f'{IMAGE}: the sweep of {time:.1f} s has no {SCAN} of the same stamp and number of '
            'beams, which would say at which angles they look'
        )
    height, width = (
        tow.measured[name].near(time, READING_AWAY_S) if name in tow.measured else math.nan
        for name in ('opening_height', 'opening_width')
    )
    mouth, closed = _mouth(moment)
    return SonarPicture(time, image, scan, height, width, mouth, closed)


def _mouth(moment: Moment) -> tuple[np.ndarray, bool]:
    """Truth of the mouth in the sonar's plane (n, 2): its section, or the ropes turned into it."""
    if SECTION in moment.messages:
        through = read_point_cloud(SECTION, moment.messages[SECTION], ('x', 'y'))
        if len(through):
            return through, False
    if MOUTH in moment.messages and POSE in moment.messages:
        pose = moment.messages[POSE].pose
        turn, place = pose.orientation, pose.position
        axes = Rotation.from_quat([turn.x, turn.y, turn.z, turn.w]).as_matrix()
        return (corners(moment) - [place.x, place.y, place.z]) @ axes[:, :2], True
    return np.zeros((0, 2)), False


def corners(moment: Moment) -> np.ndarray:
    """Corners (2 N, 3) of the mouth in ``map``: headrope from port, footrope back."""
    points = moment.messages[MOUTH].polygon.points
    return np.array([[point.x, point.y, point.z] for point in points], dtype=float)
