"""Conversion of quality of service (QoS) from graph to bag, and back."""

from collections.abc import Sequence

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
from trawl_ros.core.time import SECOND

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
