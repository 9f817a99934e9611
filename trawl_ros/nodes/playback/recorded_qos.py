# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Conversion of quality of service (QoS) from graph to bag, and back."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)

from trawl_ros.bags.storage.qos import FOREVER
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.time import SECOND

ALL = 'all'


class TopicChoice:
    """Predicate of full topic names.

    Parameters
    ----------
    project
        The project's own, wanted where nothing else is.
    named
        Full names; ``{'all'}`` stands for every topic.
    patterns
        Expressions of RE2 by parameter: ``regex`` adds the topics in whose names it is found,
        ``exclude_regex`` takes such away; '' is none.
    never
        Full names that are never wanted.

    Raises
    ------
    TrawlError
        If an expression is none.
    """

    def __init__(
        self,
        project: Collection[str],
        named: Collection[str],
        patterns: Mapping[str, str],
        never: Collection[str],
    ) -> None:
        compiled = {name: _compiled(name, pattern) for name, pattern in patterns.items()}
        self._added, self._left_out = compiled.get('regex'), compiled.get('exclude_regex')
        self._everything = ALL in named
        self._named = frozenset(named) if named or self._added else frozenset(project)
        self._never = frozenset(never)

    def __contains__(self, topic: Any) -> bool:
        if topic in self._never or (self._left_out and self._left_out.search(topic)):
            return False
        if self._everything or topic in self._named:
            return True
        return self._added is not None and self._added.search(topic) is not None


def _compiled(parameter: str, pattern: str) -> Any:
    """Compile an expression whose search takes a time in proportion to the name's length.

    Other nodes choose names of topics: Python's own expressions may take years for one.
    """
    if not pattern:
        return None
    import re2  # only where it is needed, as it is by few

    options = re2.Options()
    options.log_errors = False
    try:
        return re2.compile(pattern, options)
    except re2.error as reason:
        (words,) = reason.args
        raise TrawlError(
            f'parameter {parameter}: found {pattern!r}, expected a regular expression of RE2, '
            f'which has no look-around and no back-references ({words.decode()})'
        ) from None


_RELIABILITIES = (QosReliability.RELIABLE, QosReliability.BEST_EFFORT)
_DURABILITIES = (QosDurability.TRANSIENT_LOCAL, QosDurability.VOLATILE)
_LIVELINESSES = (QosLiveliness.AUTOMATIC, QosLiveliness.MANUAL_BY_TOPIC)

# Infinity of Fast DDS and Connext in bags of Foxy (rosbag2_storage, qos.cpp).
_FOREVER_OF_FOXY = (
    QosTime(0x7FFFFFFF, 0xFFFFFFFF),
    QosTime(0x7FFFFFFF, 0x7FFFFFFF),
)


def profiles_of(publishers: Sequence[TopicEndpointInfo]) -> tuple[Qos, ...]:
    """Return the profiles that publishers offer, each different one once.

    Middlewares do not tell others the history and its depth; they stand as unknown and 0, as
    they do in bags of rosbag2.
    """
    return tuple(dict.fromkeys(_as_recorded(publisher.qos_profile) for publisher in publishers))


def offered_again(recorded: Sequence[Qos], default: QoSProfile) -> QoSProfile | None:
    """Return the profile of a player in place of the recorded publishers.

    Parameters
    ----------
    recorded
        Profiles of the publishers.
    default
        Stands in for what is not known of it.

    Returns
    -------
    QoSProfile or None
        None where they offered different things, so that no one publisher can do the same.
        History and depth are as recorded where late subscribers can tell; otherwise they are at
        least those of ``default``, so that a fast player loses nothing.
    """
    alike = {
        qos._replace(history=QosHistory.UNKNOWN, depth=0, lifespan=FOREVER) for qos in recorded
    }
    if not recorded:
        return default
    if len(alike) > 1:
        return None
    first = recorded[0]
    latched = first.durability is QosDurability.TRANSIENT_LOCAL
    depths = [qos.depth for qos in recorded if qos.history is QosHistory.KEEP_LAST and qos.depth]
    depth = max(depths, default=default.depth)
    profile = QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth if latched else max(depth, default.depth),
        reliability=default.reliability,
        durability=default.durability,
        deadline=_duration(first.deadline),
        lifespan=_duration(first.lifespan),
        liveliness_lease_duration=_duration(first.liveliness_lease_duration),
        avoid_ros_namespace_conventions=first.avoid_ros_namespace_conventions,
    )
    if latched and any(qos.history is QosHistory.KEEP_ALL for qos in recorded):
        profile.history = HistoryPolicy.KEEP_ALL
    if first.reliability in _RELIABILITIES:
        profile.reliability = ReliabilityPolicy(first.reliability.value)
    if first.durability in _DURABILITIES:
        profile.durability = DurabilityPolicy(first.durability.value)
    if first.liveliness in _LIVELINESSES:
        profile.liveliness = LivelinessPolicy(first.liveliness.value)
    return profile


def _as_recorded(profile: QoSProfile) -> Qos:
    return Qos(
        history=QosHistory(int(profile.history)),
        depth=int(profile.depth),
        reliability=QosReliability(int(profile.reliability)),
        durability=QosDurability(int(profile.durability)),
        deadline=_time(profile.deadline),
        lifespan=_time(profile.lifespan),
        liveliness=QosLiveliness(int(profile.liveliness)),
        liveliness_lease_duration=_time(profile.liveliness_lease_duration),
        avoid_ros_namespace_conventions=bool(profile.avoid_ros_namespace_conventions),
    )


def _time(duration: Duration) -> QosTime:
    # Without a limit is 2⁶³ − 1 ns, which comes out as rosbag2's own infinity.
    return QosTime(*divmod(int(duration.nanoseconds), SECOND))


def _duration(time: QosTime) -> Duration:
    endless = time in _FOREVER_OF_FOXY or time.sec >= FOREVER.sec
    seconds, nanoseconds = FOREVER if endless else time
    return Duration(seconds=seconds, nanoseconds=nanoseconds)
