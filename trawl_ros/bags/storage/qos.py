# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Offered quality of service (QoS), as bags store it.

Records and parser are those of ``rosbags``, which knows both forms: up to version 8 a list in a
string, with numbers, and from version 9 on a plain list, with words.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import yaml
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

from trawl_ros.core.errors import BagError

FOREVER = QosTime(9223372036, 854775807)
"""Duration without limit, as rosbag2 writes it (``RMW_DURATION_INFINITE``)."""

MAX_TEXT = 1 << 16
"""Longest text of profiles that is parsed, characters; a hundred publishers need less."""

_ONE_LINE = 1 << 20
_Dumper: Any = getattr(yaml, 'CSafeDumper', yaml.SafeDumper)


def project_profile(latched: bool) -> Qos:
    """QoS profile of the project's own publishers."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else 100,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=FOREVER,
        lifespan=FOREVER,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=FOREVER,
        avoid_ros_namespace_conventions=False,
    )


def dump_profiles(profiles: Sequence[Qos]) -> str:
    """Write profiles as rosbag2 does up to version 8; '' for none."""
    if not profiles:
        return ''
    listed = [
        {
            'history': profile.history.value,
            'depth': profile.depth,
            'reliability': profile.reliability.value,
            'durability': profile.durability.value,
            'deadline': profile.deadline._asdict(),
            'lifespan': profile.lifespan._asdict(),
            'liveliness': profile.liveliness.value,
            'liveliness_lease_duration': profile.liveliness_lease_duration._asdict(),
            'avoid_ros_namespace_conventions': profile.avoid_ros_namespace_conventions,
        }
        for profile in profiles
    ]
    text: str = yaml.dump(listed, Dumper=_Dumper, sort_keys=False, width=_ONE_LINE)
    return text.strip()


def parse_profiles(topic: str, offered: Any) -> tuple[Qos, ...]:
    """Read ``offered_qos_profiles`` of a topic: text, or the list of version 9.

    Raises
    ------
    BagError
        If it is neither, or lacks a policy.
    """
    # Imported here: it takes a recorder's start long, which reads none.
    from rosbags.rosbag2 import ReaderError
    from rosbags.rosbag2.metadata import parse_qos

    try:
        if isinstance(offered, str) and len(offered) > MAX_TEXT:
            raise ValueError(f'{len(offered)} characters')
        profiles = _read(offered) if isinstance(offered, str) else tuple(parse_qos(offered))
        for profile in profiles:
            times = (profile.deadline, profile.lifespan, profile.liveliness_lease_duration)
            for number in (profile.depth, *(part for time in times for part in time)):
                if not isinstance(number, int) or number < 0:
                    raise ValueError(f'{number!r} where a number from 0 on belongs')
        return profiles
    except (ReaderError, KeyError, TypeError, ValueError, AttributeError, RecursionError) as reason:
        raise BagError(
            f'{topic}: offered_qos_profiles cannot be understood ({type(reason).__name__}: '
            f'{reason}); expected a list of profiles as rosbag2 writes it'
        ) from reason


@lru_cache(maxsize=64)
def _read(text: str) -> tuple[Qos, ...]:
    """Read profiles from text; cached, since parsing is slow and most topics are equal."""
    from rosbags.rosbag2.metadata import parse_qos

    return tuple(parse_qos(text))
