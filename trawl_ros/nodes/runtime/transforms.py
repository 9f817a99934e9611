# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Transforms that nodes send: mounts of sensors, and the pose of a real ship."""

import math
from collections.abc import Sequence

import numpy as np

from trawl_ros.core.geodesy import Datum, to_east_north
from trawl_ros.core.time import SECOND
from trawl_ros.messages.pieces import TopicMessage
from trawl_ros.messages.transforms import mounts_message, ship_transform
from trawl_ros.nodes.runtime.incoming import installed
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.records.frames import Mount
from trawl_ros.records.samples import FixSample, HeadingSample, Sample
from trawl_ros.records.topics import STATIC_TRANSFORMS, TRANSFORMS

MAX_HEADING_AGE_S = 5.0
"""Largest difference between the stamps of a fix and of the heading that goes with it."""


def send_mounts(node: TrawlNode, mounts: Sequence[Mount]) -> None:
    """Publish on /tf_static where sensors are fixed, if tf2_msgs is installed."""
    # The package index has no tf2_msgs; a full installation has.
    if installed(STATIC_TRANSFORMS.type):
        node.advertise(STATIC_TRANSFORMS.name)
        node.send(*mounts_message(node.now(), mounts))


def sends_transforms(node: TrawlNode) -> bool:
    """Advertise /tf if tf2_msgs is installed; return whether it is."""
    there = installed(TRANSFORMS.type)
    if there:
        node.advertise(TRANSFORMS.name)
    return there


class ShipPose:
    """Pose of a real ship in ``map``, from her position and heading.

    Parameters
    ----------
    datum
        Origin of ``map``.
    odom
        Whether frame ``odom`` lies between ``map`` and the ship.
    """

    def __init__(self, datum: Datum, *, odom: bool) -> None:
        self._datum, self._odom = datum, odom
        self._heading: HeadingSample | None = None

    def take(self, sample: Sample) -> TopicMessage | None:
        """Take a sample; return the transform if it is a fix that a heading goes with."""
        if isinstance(sample, HeadingSample) and math.isfinite(sample.heading):
            self._heading = sample
        if not isinstance(sample, FixSample) or self._heading is None:
            return None
        old = abs(sample.stamp - self._heading.stamp) > MAX_HEADING_AGE_S * SECOND
        if old or not math.isfinite(sample.latitude + sample.longitude):
            return None
        place = np.array([sample.latitude]), np.array([sample.longitude])
        east, north = to_east_north(*place, self._datum)
        position = (float(east[0]), float(north[0]), 0.0)
        return ship_transform(sample.stamp, position, self._heading.heading, odom=self._odom)
