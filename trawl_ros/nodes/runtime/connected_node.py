# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Node connected by topics and services: bytes in and out."""

import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo
from std_srvs.srv import Trigger

from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import SENTENCE
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.transforms import rename_frames
from trawl_ros.nodes.graph.graph_checks import SHARED, UNKNOWN, of_one_node
from trawl_ros.nodes.graph.source import Source, asks_more, matching
from trawl_ros.nodes.runtime.incoming import (
    Incoming,
    Turns,
    believing_clock,
    decoding,
    error_of_program,
    message_class,
    settling,
)
from trawl_ros.nodes.runtime.qos import offered, overriding
from trawl_ros.nodes.runtime.traffic import Traffic
from trawl_ros.records.topics import CLOCK, NAMESPACE, find_topic

DIAGNOSTICS = '/diagnostics'

RCLError = rclpy_implementation.RCLError


@dataclass(frozen=True)
class Listener:
    """Subscription with the type of its topic.

    ``subscribe`` makes another one from a QoS profile and a flag: may users override it?
    """

    subscription: Subscription
    type_name: str
    subscribe: Callable[[QoSProfile, bool], Subscription]


KNOWN_S = 5.0
"""Wall time (s) for which endpoints of a topic are not asked for again while their number is the
same: each diagnostic report of each node would take 15 ms."""


@dataclass(frozen=True)
class _Known:
    """Endpoints of a topic, as they were when there were so many."""

    count: int
    until: float
    endpoints: list[TopicEndpointInfo]


class ConnectedNode(Node):
    """Node connected by topics and services: ROS gets and gives bytes, all of them counted.

    Parameters
    ----------
    name
        Of the node.
    **kwargs
        As for `rclpy.node.Node`. The namespace is ``trawl`` unless given.

    Attributes
    ----------
    traffic : Traffic
        Counts of messages in and out.
    turns : Turns
        Turns of its callbacks.
    exit_code : int or None
        Set by `end`; whoever spins the node then stops.
    frame_names : dict of str to str
        Published names of the frames that have another one than their own.
    """

    def __init__(self, name: str, **kwargs: Any) -> None:
        kwargs.setdefault('namespace', NAMESPACE)
        # Before ROS itself listens to /clock.
        self.traffic = Traffic()
        self._refused: dict[str, str] = {}
        self._sources: dict[str, Source] = {}
        self._known: dict[tuple[str, str], _Known] = {}
        self.turns = Turns()
        super().__init__(name, **kwargs)
        self.exit_code: int | None = None
        self.frame_names: dict[str, str] = {}
        self._senders: dict[str, Publisher] = {}
        self._listeners: dict[str, Listener] = {}

    def full_name(self, topic: str) -> str:
        """Return a topic's full name after namespace and remapping."""
        name: str = self.resolve_topic_name(topic)
        return name

    def now(self) -> int:
        """Return the time of the node's clock, ns."""
        stamp: int = self.get_clock().now().nanoseconds
        return stamp

    def advertise(
        self, topic: str, type_name: str | None = None, profile: QoSProfile | None = None
    ) -> Publisher:
        """Create the publisher of a topic; the table has type and QoS of the project's own."""
        if topic not in self._senders:
            self._senders[topic] = self.create_publisher(
                message_class(self._type_of(topic, type_name)),
                topic,
                # ROS writes overrides into the profile itself, which others are made of too.
                copy(profile or offered(find_topic(topic, self.get_namespace()))),
                qos_overriding_options=overriding(),
            )
            self.traffic.expect('published', self.full_name(topic))
        return self._senders[topic]

    def send(self, topic: str, message: Any) -> None:
        """Publish a message on an advertised topic."""
        if self.frame_names:
            rename_frames(message, self.frame_names)
        self.send_bytes(topic, serialize(message))

    def send_bytes(self, topic: str, data: bytes) -> None:
        """Publish a message that is CDR already."""
        sender = self._senders[topic]
        try:
            sender.publish(data)
        except RCLError:
            # Shut down in the middle of a callback or of a thread's work, ROS hears nothing more.
            if self.context.ok():
                raise
            return
        self.traffic.count('published', sender.topic_name)

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], None],
        *args: Any,
        single: bool = False,
        **kwargs: Any,
    ) -> Subscription:
        """Subscribe as any node does; ROS itself subscribes to /clock by this.

        What goes wrong with a message is counted and said, and the node lives on. With ``single``
        it stays with one publisher.
        """
        full = self.full_name(topic)
        if full == CLOCK.name and not kwargs.get('raw'):
            callback = believing_clock(callback, lambda reason: self.refuse(full, reason))
        # Made before the subscription that it asks.
        source = Source(
            lambda: subscription.get_publisher_count(),
            namesakes=lambda: of_one_node(self.get_publishers_info_by_topic(full)),
        )
        subscription = super().create_subscription(
            msg_type,
            topic,
            Incoming(
                full,
                callback,
                lambda reason: self.refuse(full, reason),
                lambda reason: self.end(1, reason),
                source,
                single,
                self.turns,
            ),
            *args,
            # Asked for an event while another one comes in, the middleware locks up for ever.
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            **kwargs,
        )
        self._sources[full] = source
        return subscription

    def listen(
        self,
        topic: str,
        handler: Callable[[Any], None],
        profile: QoSProfile,
        type_name: str | None = None,
        *,
        settled: bool = False,
    ) -> None:
        """Subscribe; messages that cannot be used are counted and said, not raised.

        With ``settled`` those are held back that are stamped far from the ones before, until
        three agree.
        """
        kind = self._type_of(topic, type_name)
        if settled:
            handler = settling(topic, handler, lambda reason: self.refuse(topic, reason))
        self.listen_raw(
            topic, kind, decoding(topic, kind, handler), profile, single=self._is_single(topic)
        )

    def listen_raw(
        self,
        topic: str,
        type_name: str,
        handler: Callable[[bytes], None],
        profile: QoSProfile,
        *,
        overridable: bool = True,
        single: bool = False,
    ) -> None:
        """Subscribe to the bytes of a topic.

        ``overridable`` lets users override the profile; ``single`` as for `create_subscription`.
        """
        full = self.full_name(topic)

        def take(data: bytes) -> None:
            self.traffic.count('received', full)
            handler(data)

        def subscribe(profile: QoSProfile, overridable: bool) -> Subscription:
            return self.create_subscription(
                message_class(type_name),
                topic,
                take,
                profile,
                qos_overriding_options=overriding() if overridable else None,
                raw=True,
                single=single,
            )

        subscription = subscribe(copy(profile), overridable)
        self._listeners[full] = Listener(subscription, type_name, subscribe)
        self.traffic.expect('received', full)

    def get_publishers_info_by_topic(self, topic: str) -> list[TopicEndpointInfo]:
        """Return the publishers of a topic; asked of ROS again when their number changes."""
        count = self.count_publishers(topic)
        return self._known_endpoints(('publishers', topic), count)

    def get_subscriptions_info_by_topic(self, topic: str) -> list[TopicEndpointInfo]:
        """Return the subscriptions of a topic; asked of ROS again when their number changes."""
        count = self.count_subscribers(topic)
        return self._known_endpoints(('subscriptions', topic), count)

    def _known_endpoints(self, of: tuple[str, str], count: int) -> list[TopicEndpointInfo]:
        known, now = self._known.get(of), time.monotonic()
        if known is None or known.count != count or now > known.until:
            which, topic = of
            found = getattr(super(), f'get_{which}_info_by_topic')(topic)
            named = len(found) == count and all(info.node_name != UNKNOWN for info in found)
            known = _Known(count, now + (KNOWN_S if named else 0.0), found)
            self._known[of] = known
        return known.endpoints

    def match_publishers(self) -> None:
        """Subscribe again, asking for less QoS, where a publisher would not be heard otherwise."""
        for full, listener in list(self._listeners.items()):
            asked = listener.subscription.qos_profile
            heard = matching(self.get_publishers_info_by_topic(full), asked)
            if asks_more(asked, heard):
                self.destroy_subscription(listener.subscription)
                # Parameters of the first subscription would be forced upon this one.
                again = listener.subscribe(heard, False)
                self._listeners[full] = replace(listener, subscription=again)
                offer = f'{heard.reliability.name} and {heard.durability.name}'.lower()
                self.get_logger().info(f'{full}: hears what its publishers offer, which is {offer}')

    def offer(self, service: str, act: Callable[[], str]) -> None:
        """Offer a Trigger service; an error of what it does is its refusal, with reason."""

        def answer(request: Any, response: Any) -> Any:
            try:
                with self.turns as mine:
                    if not mine:
                        raise TrawlError('the node is ending')
                    response.success, response.message = True, act()
            except Exception as reason:
                response.success, response.message = False, self.refusal(service, reason)
            return response

        self.create_service(Trigger, service, answer)

    def refusal(self, service: str, reason: Exception) -> str:
        """Return what a service answers where an error kept it; log one of the program."""
        if isinstance(reason, TrawlError):
            return str(reason)
        sentence = error_of_program(reason)
        self.get_logger().error(f'{service}: {sentence}')
        return sentence

    @property
    def subscribed(self) -> dict[str, str]:
        """Types of the topics listened to, by full name."""
        return {full: listener.type_name for full, listener in self._listeners.items()}

    def stop_listening(self, topic: str) -> None:
        """Destroy a subscription; its counts stay."""
        self.destroy_subscription(self._listeners.pop(self.full_name(topic)).subscription)

    def refuse(self, topic: str, reason: str) -> None:
        """Count a message that is not used, and log the reason when it is new."""
        full = self.full_name(topic)
        # A reason may repeat what the message brought along.
        reason = one_line(reason, SENTENCE.value)
        self.traffic.count('refused', full)
        if self._refused.get(full) != reason:
            self._refused[full] = reason
            self.get_logger().warning(f'left out a message: {reason}')

    def subscribers(self) -> dict[str, tuple[int, int]]:
        """Return by topic the number of matched and of known subscribers."""
        return {
            topic: (sender.get_subscription_count(), self.count_subscribers(topic))
            for topic, sender in self._senders.items()
            if topic != DIAGNOSTICS
        }

    def all_acknowledged(self, timeout_s: float) -> bool:
        """Wait until subscribers have all that was published; False after the time."""
        end = time.monotonic() + timeout_s
        # One who is gone without a word acknowledges nothing; the time is that for all topics.
        return all(
            sender.wait_for_all_acked(Duration(seconds=max(0.0, end - time.monotonic())))
            for sender in list(self._senders.values())
        )

    def end(self, exit_code: int, reason: str = '') -> None:
        """Request the executor to stop."""
        if reason:
            (self.get_logger().error if exit_code else self.get_logger().info)(reason)
        self.exit_code = exit_code

    def _is_single(self, topic: str) -> bool:
        """True if a topic of the contract is to have one publisher."""
        shared = {self.full_name(name) for name in SHARED}
        row = find_topic(topic, self.get_namespace())
        return row is not None and self.full_name(topic) not in shared

    def _type_of(self, topic: str, type_name: str | None) -> str:
        if type_name is not None:
            return type_name
        if (row := find_topic(topic, self.get_namespace())) is None:
            raise MessageError(f'{topic}: not a topic of the project, so its type is needed')
        return row.type
