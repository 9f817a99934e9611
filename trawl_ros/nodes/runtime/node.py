"""Base class of all nodes: bytes in and out, diagnostics, a clean end."""

import time
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from typing import Any, ClassVar

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from rclpy.timer import Timer
from std_srvs.srv import Trigger

from trawl_ros.core.errors import MessageError, TrawlError
from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import DIAGNOSIS, SENTENCE
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.nodes.runtime.graph_checks import (
    SHARED,
    Listening,
    clock_status,
    connection_problems,
)
from trawl_ros.nodes.runtime.headway import Headway
from trawl_ros.nodes.runtime.incoming import (
    Incoming,
    believing_clock,
    decoding,
    error_of_program,
    settling,
)
from trawl_ros.nodes.runtime.introduction import introduction
from trawl_ros.nodes.runtime.message_classes import message_class
from trawl_ros.nodes.runtime.parameters import Parameters, Spec
from trawl_ros.nodes.runtime.qos import offered, overriding
from trawl_ros.nodes.runtime.source import Source
from trawl_ros.nodes.runtime.traffic import Traffic
from trawl_ros.records.topics import CLOCK, NAMESPACE, find_topic

DIAGNOSTICS = '/diagnostics'
DIAGNOSTICS_PERIOD_S = 1.0


class TrawlNode(Node):
    """Node of the project. Messages are the project's own; ROS gets and gives bytes.

    Parameters
    ----------
    name
        Of the node.
    **kwargs
        As for `rclpy.node.Node`. The namespace is ``trawl`` unless given.

    Attributes
    ----------
    parameters : Parameters
        The node's declared parameters.
    traffic : Traffic
        Counts of messages in and out.
    headway : Headway
        Newest stamps of its data.
    exit_code : int or None
        Set by `end`; whoever spins the node then stops.

    Raises
    ------
    ParameterError
        If a parameter is of the wrong kind or out of range.
    """

    SPECS: ClassVar[tuple[Spec, ...]] = ()
    DRAINS: ClassVar[bool] = False
    """True if messages on their way are still to be taken in when told to stop."""

    AWAITS: ClassVar[bool] = False
    """True if callbacks await something, which the events executor does not know."""

    def __init__(self, name: str, **kwargs: Any) -> None:
        kwargs.setdefault('namespace', NAMESPACE)
        # Before ROS itself listens to /clock.
        self.traffic = Traffic()
        self._refused: dict[str, str] = {}
        self._troubles: dict[str, str] = {}
        self._sources: dict[str, Source] = {}
        super().__init__(name, **kwargs)
        self.headway = Headway()
        self.exit_code: int | None = None
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._senders: dict[str, Publisher] = {}
        self._listeners: dict[str, tuple[Subscription, str]] = {}
        self._said: dict[str, tuple[int, str]] = {}
        self._closed = False
        self.parameters = Parameters(self, self.SPECS, self.objection, self.parameter_changed)
        self.advertise(DIAGNOSTICS)
        self.every(DIAGNOSTICS_PERIOD_S, self._diagnose)

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""

    def statuses(self) -> list[Status]:
        """Return the diagnostics of the node's own subsystems."""
        return []

    def finish_work(self) -> None:
        """Finish the node's work; called once, before the last diagnostics."""

    def introduce(self) -> None:
        """Log the node's purpose, parameters and topics."""
        own = [sender.topic_name for name, sender in self._senders.items() if name != DIAGNOSTICS]
        values = {spec.name: self.parameters[spec.name] for spec in self.SPECS}
        topics = {'publishes': own, 'listens to': list(self._listeners)}
        for line in introduction(type(self), values, self.get_namespace(), topics):
            self.get_logger().info(line)

    def full_name(self, topic: str) -> str:
        """Return a topic's full name after namespace and remapping."""
        return self.resolve_topic_name(topic)

    def now(self) -> int:
        """Return the time of the node's clock, ns."""
        return self.get_clock().now().nanoseconds

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
        self.send_bytes(topic, serialize(message))

    def send_bytes(self, topic: str, data: bytes) -> None:
        """Publish a message that is CDR already."""
        sender = self._senders[topic]
        sender.publish(data)
        self.traffic.count('published', sender.topic_name)

    def every(self, period_s: float, callback: Callable[[], None]) -> Timer:
        """Call back at a period of wall time, whatever ROS time does."""

        def call() -> None:
            # Raised on, it would come out of the executor, or end other nodes too.
            try:
                callback()
            except TrawlError as reason:
                self.end(1, str(reason))
            except Exception as reason:
                self._note_trouble(callback.__qualname__, error_of_program(reason))

        return self.create_timer(period_s, call, clock=self.steady_clock)

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
        source = Source(lambda: subscription.get_publisher_count())
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

        subscription = self.create_subscription(
            message_class(type_name),
            topic,
            take,
            copy(profile),
            qos_overriding_options=overriding() if overridable else None,
            raw=True,
            single=single,
        )
        self._listeners[full] = (subscription, type_name)
        self.traffic.expect('received', full)

    def offer(self, service: str, act: Callable[[], str]) -> None:
        """Offer a Trigger service; an error of what it does is its refusal, with reason."""

        def answer(request: Any, response: Any) -> Any:
            try:
                response.success, response.message = True, act()
            except TrawlError as reason:
                response.success, response.message = False, str(reason)
            except Exception as reason:
                response.success, response.message = False, error_of_program(reason)
                self.get_logger().error(f'{service}: {response.message}')
            return response

        self.create_service(Trigger, service, answer)

    def stop_listening(self, topic: str) -> None:
        """Destroy a subscription; its counts stay."""
        subscription, _ = self._listeners.pop(self.full_name(topic))
        self.destroy_subscription(subscription)

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

    def close(self) -> None:
        """Finish work and report the final counts; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self.finish_work()
        if self.context.ok():
            self._diagnose()
            self.all_acknowledged(0.5)

    def destroy_node(self) -> None:
        """Close and destroy."""
        self.close()
        super().destroy_node()

    def say(self, name: str, level: int, message: str) -> None:
        """Log a change of a subsystem's state."""
        if self._said.get(name, (OK, '')) == (level, message):
            return
        before = self._said.get(name, (OK, ''))[0]
        self._said[name] = (level, message)
        log = self.get_logger()
        if level == ERROR:
            log.error(f'{name}: {message}')
        elif level == WARN:
            log.warning(f'{name}: {message}')
        elif before != OK:
            log.info(f'{name}: {message}')

    def _note_trouble(self, what: str, sentence: str) -> None:
        if self._troubles.get(what) != sentence:
            self._troubles[what] = sentence
            self.get_logger().error(f'{what}: {sentence}')

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

    def all_statuses(self) -> list[Status]:
        """Give what the node says of itself on /diagnostics, each sentence and value bounded."""
        clock = clock_status(self)
        clock = replace(clock, values={**clock.values, **self.headway.report()})
        return [_bounded(one) for one in (self._traffic_status(), clock, *self.statuses())]

    def _diagnose(self) -> None:
        statuses = self.all_statuses()
        for status in statuses:
            self.say(status.name, status.level, status.message)
        prefix = self.get_fully_qualified_name()
        named = [
            Status(f'{prefix}: {s.name}', s.level, s.message, s.values, self.get_name())
            for s in statuses
        ]
        # Counted beforehand, so that the message's own count includes itself.
        self.traffic.count('published', DIAGNOSTICS)
        self._senders[DIAGNOSTICS].publish(serialize(diagnostic_array(self.now(), named)))

    def _traffic_status(self) -> Status:
        problems = connection_problems(
            self,
            {
                topic: Listening(type_name, subscription.qos_profile)
                for topic, (subscription, type_name) in self._listeners.items()
            },
            {sender.topic_name: sender.qos_profile for sender in self._senders.values()},
        )
        if refused := self.traffic.total('refused'):
            last = next(reversed(self._refused.values()))
            problems.append(f'{refused} messages left out, the last because {last}')
        # Older messages of a latched topic are meant to be given up for its newest.
        for full, (subscription, _) in self._listeners.items():
            if subscription.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL:
                self.traffic.lost(full, self._sources[full].lost)
        if dropped := self.traffic.dropped:
            problems.append(f'{dropped} messages were lost on the way here')
        values = self.traffic.report()
        message = '; '.join(problems) or 'messages are flowing as they should'
        level = WARN if problems else OK
        if self._troubles:
            what, sentence = list(self._troubles.items())[-1]
            level, message = ERROR, f'{what}: {sentence}'
        return Status('messages', level, message, values)


def _bounded(status: Status) -> Status:
    """Cut what may repeat something foreign, as the names of consumers."""
    values = {key: one_line(value, DIAGNOSIS.value) for key, value in status.values.items()}
    return replace(status, message=one_line(status.message, DIAGNOSIS.value), values=values)
