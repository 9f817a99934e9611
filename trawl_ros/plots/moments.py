# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Moments of a bag: the messages nearest to chosen times, and the sonar's sweeps among them."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.arrays import FloatArray
from trawl_ros.core.errors import MessageError
from trawl_ros.core.time import SECOND
from trawl_ros.messages.from_messages import to_sample
from trawl_ros.messages.point_clouds import read_point_cloud
from trawl_ros.plots.records import SonarPicture, TowHistory
from trawl_ros.records.samples import SonarImageSample, SonarScanSample
from trawl_ros.records.topics import absolute

GEAR, MOUTH, POSE = 'truth/gear', 'truth/net/mouth', 'truth/sonar/pose'
SECTION, IMAGE, SCAN = 'truth/sonar/section', 'sonar/image', 'sonar/scan'
MOST_AWAY_S = {GEAR: 10.0, MOUTH: 10.0, POSE: 10.0, SECTION: 10.0, IMAGE: 120.0, SCAN: 120.0}
"""Longest time between a chosen instant and a message that is drawn for it."""


Sweep = tuple[SonarImageSample, SonarScanSample]

READING_AWAY_S = 60.0
"""Longest time between a sweep and a reading of the opening that belongs to it."""


@dataclass(frozen=True)
class Moment:
    """Messages nearest to ``time`` (s), by topic."""

    time: float
    messages: Mapping[str, Any]


def read_moments(
    path: Path, tow: TowHistory, times: Sequence[float], namespace: str, topics: Iterable[str]
) -> Iterator[Moment]:
    """Yield the messages nearest to each of the times (s, rising).

    At most as many messages of a topic are kept as there are times, and each is decoded only when
    needed.
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


def read_sweeps(
    path: Path, tow: TowHistory, times: Sequence[float], namespace: str
) -> tuple[list[SonarPicture | None], list[str]]:
    """Find the sweep received nearest to each of the times (s, rising).

    Returns
    -------
    list
        A picture per time; None if no sweep is near, or the angles of its beams are unknown.
    list
        A sentence for each sweep with unknown angles.
    """
    sweeps: list[Sweep | None] = []
    problems: list[str] = []
    for moment in read_moments(path, tow, times, namespace, [IMAGE, SCAN]):
        try:
            sweeps.append(sweep_of(moment, tow))
        except MessageError as reason:
            sweeps.append(None)
            problems.append(str(reason))
    if not any(sweeps):
        return [None for _ in times], problems
    # Truth from the middle of the sweep, so that neither its first nor its last beams are far off.
    middles = [
        time if sweep is None else tow.time(sweep[0].stamp) + 0.5 * sweep[1].sweep_s
        for time, sweep in zip(times, sweeps, strict=True)
    ]
    order = np.argsort(middles, kind='stable')
    there = read_moments(path, tow, [middles[k] for k in order], namespace, [SECTION, MOUTH, POSE])
    pictures: list[SonarPicture | None] = [None for _ in times]
    for k, moment in zip(order, there, strict=True):
        sweep = sweeps[k]
        if sweep is not None:
            pictures[k] = _picture(sweep, moment, tow)
    return pictures, problems


def sweep_of(moment: Moment, tow: TowHistory) -> Sweep | None:
    """Image with the scan that belongs to it; None without an image.

    Raises
    ------
    MessageError
        If no scan says at which angles the image's beams look.
    """
    if IMAGE not in moment.messages:
        return None
    image = to_sample(IMAGE, moment.messages[IMAGE])
    assert isinstance(image, SonarImageSample)
    scan = to_sample(SCAN, moment.messages[SCAN]) if SCAN in moment.messages else None
    if (
        not isinstance(scan, SonarScanSample)
        or scan.stamp != image.stamp
        or len(scan.ranges) != len(image.image)
    ):
        raise MessageError(
            f'{IMAGE}: the sweep of {tow.time(image.stamp):.1f} s has no {SCAN} of the same stamp '
            'and number of beams, which would say at which angles they look'
        )
    return image, scan


def _picture(sweep: Sweep, moment: Moment, tow: TowHistory) -> SonarPicture:
    image, scan = sweep
    time = tow.time(image.stamp)
    height, width = (
        tow.measured[name].near(time, READING_AWAY_S) if name in tow.measured else math.nan
        for name in ('opening_height', 'opening_width')
    )
    mouth, closed = _mouth(moment)
    return SonarPicture(time, image, scan, height, width, mouth, closed)


def _mouth(moment: Moment) -> tuple[FloatArray, bool]:
    """Truth in the sonar's plane (n, 2): its section, or the ropes rotated into it."""
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
