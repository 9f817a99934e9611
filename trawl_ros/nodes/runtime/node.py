# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""Base class of all nodes: parameters, diagnostics, a clean end."""

import time
from collections.abc import Callable, Coroutine, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.qos import DurabilityPolicy
from rclpy.service import Service
from rclpy.timer import Timer
from std_srvs.srv import Trigger

from trawl_ros.core.errors import TrawlError
from trawl_ros.core.files import free_path, require_writable
from trawl_ros.core.foreign import one_line
from trawl_ros.core.limits import DIAGNOSIS
from trawl_ros.core.time import SECOND
from trawl_ros.messages.cdr import serialize
from trawl_ros.messages.diagnostics import ERROR, OK, WARN, Status, diagnostic_array
from trawl_ros.nodes.graph.graph_checks import clock_status, connection_problems, elsewhere
from trawl_ros.nodes.runtime.connected_node import DIAGNOSTICS, ConnectedNode
from trawl_ros.nodes.runtime.frames import frame_specs, published_names
from trawl_ros.nodes.runtime.incoming import (
    error_of_program,
)
from trawl_ros.nodes.runtime.parameters import ParameterError, Parameters, Spec
from trawl_ros.nodes.runtime.traffic import RealTimeFactor
from trawl_ros.records.topics import CLOCK

PERIOD_S = 0.1
"""Period at which requests are taken, and coroutines asked."""

Answer = Callable[[Any, Any], Coroutine[Any, Any, Any]]


class AwaitingService:
    """Answers of a service that no executor sees.

    Parameters
    ----------
    service
        Of a node that does not list it among its services.
    answer
        Coroutine function from request and response to the response; raises nothing.
    """

    def __init__(self, service: Service, answer: Answer) -> None:
        self._service, self._answer = service, answer
        self._pending: list[tuple[Coroutine[Any, Any, Any], Any]] = []

    def go_on(self) -> None:
        """Take a request, where there is one, and send the answers that are there."""
        kind, handle = self._service.srv_type, self._service.handle
        with handle:
            request, header = handle.service_take_request(kind.Request)
        if header is not None:
            self._pending.append((self._answer(request, kind.Response()), header))
        for one in tuple(self._pending):
            coroutine, header = one
            try:
                coroutine.send(None)
            except StopIteration as end:
                self._pending.remove(one)
                self._service.send_response(end.value, header)


SAID = ('gear', 'scenario', 'mode', 'bag', 'output', 'state', 'time_scale', 'rate')
"""Parameters that say what a node works on."""

MOST_TOPICS = 6


def introduction(
    kind: type, values: Mapping[str, Any], namespace: str, topics: Mapping[str, Sequence[str]]
) -> list[str]:
    """Give the lines.

    Parameters
    ----------
    kind
        Class of the node; one that does not say what it does has nothing to say.
    values
        Parameters by name.
    namespace
        Of the node, with which names of topics are not to begin.
    topics
        Full names by what the node does with them.
    """
    words = vars(kind).get('__doc__')
    if not words:
        return []
    first = words.split('\n\n', 1)[0].split('. ', 1)[0]
    sentence = ' '.join(first.replace('`', '').split()).rstrip('.')
    work = [f'{name} {values[name]}' for name in SAID if values.get(name) not in (None, '')]
    lines = [f'{sentence} ({", ".join(work)})' if work else sentence]
    listed = [f'{what} {_some(names, namespace)}' for what, names in topics.items() if names]
    return [*lines, f'in {namespace}: {"; ".join(listed)}'] if listed else lines


def _some(names: Iterable[str], namespace: str) -> str:
    short = [name.removeprefix(f'{namespace.rstrip("/")}/') for name in names]
    rest = len(short) - MOST_TOPICS
    return ', '.join(short[:MOST_TOPICS]) + (f' and {rest} more' if rest > 0 else '')


DIAGNOSTICS_PERIOD_S = 1.0

GREETING_S = 0.1
"""Period of the same timer until the first report, which goes out as soon as somebody listens."""


class TrawlNode(ConnectedNode):
    """Node of the project: parameters, diagnostics, and a clean end.

    Parameters
    ----------
    name, **kwargs
        As for `ConnectedNode`.

    Attributes
    ----------
    parameters : Parameters
        The node's declared parameters.
    frames : Parameters
        Those for the names of its frames.
    real_time_factor : RealTimeFactor
        Newest stamps of its data.

    Raises
    ------
    ParameterError
        If a parameter is of the wrong kind or out of range.
    """

    SPECS: ClassVar[tuple[Spec, ...]] = ()
    DRAINS: ClassVar[bool] = False
    """True if messages on their way are still to be taken in when the node is to stop."""

    def __init__(self, name: str, **kwargs: Any) -> None:
        # Before ROS itself listens to /clock.
        self._troubles: dict[str, str] = {}
        self._awaiting: list[Service] = []
        super().__init__(name, **kwargs)
        self.real_time_factor = RealTimeFactor()
        self.steady_clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._said: dict[str, tuple[int, str]] = {}
        self.parameters = self.declare_specs(self.SPECS)
        self.frames = self.declare_specs(frame_specs(name))
        self.frame_names = published_names(name, self.frames)
        self.advertise(DIAGNOSTICS)
        # Its period changes after the greeting. Cancelled, a timer that an executor has queued
        # already would raise there.
        self._greet_until: float | None = time.monotonic() + DIAGNOSTICS_PERIOD_S
        self._reporter = self.every(GREETING_S, self._report)

    def declare_specs(self, specs: Sequence[Spec]) -> Parameters:
        """Declare parameters."""
        return Parameters(self, specs, self.objection, self.parameter_changed)

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""

    def statuses(self) -> list[Status]:
        """Return the diagnostics of the node's own subsystems."""
        return []

    def new_path(self, parameter: str, *, or_empty: bool = False, suffix: str = '') -> Path | None:
        """Return where results go by a parameter; None where it is empty.

        A node that is started again, as by ``respawn``, overwrites nothing: its path gets a number.

        Parameters
        ----------
        parameter, or_empty, suffix
            Name of the parameter; the rest as for `free_path`.

        Raises
        ------
        ParameterError
            If nothing can be written there.
        """
        wanted = self.parameters[parameter]
        if not wanted:
            return None
        path = free_path(Path(wanted), or_empty=or_empty, suffix=suffix)
        try:
            require_writable(path, ParameterError)
        except ParameterError as reason:
            raise ParameterError(f'parameter {parameter}: {reason}') from reason
        if path != Path(wanted):
            self.get_logger().warning(
                f'parameter {parameter}: {wanted} exists already and is not written over; this '
                f'run writes {path}'
            )
        return path

    def with_namespace(self, sentence: str) -> str:
        """Return a sentence on what is missing, with the namespace where the graph has it."""
        return '; '.join(filter(None, (sentence, elsewhere(self, self.subscribed))))

    def finish_work(self) -> None:
        """Finish the node's work; called once, before the last diagnostics."""

    def introduce(self) -> None:
        """Log the node's purpose, parameters and topics."""
        own = [sender.topic_name for name, sender in self._senders.items() if name != DIAGNOSTICS]
        values = {spec.name: self.parameters[spec.name] for spec in self.SPECS}
        topics = {'publishes': own, 'listens to': list(self._listeners)}
        for line in introduction(type(self), values, self.get_namespace(), topics):
            self.get_logger().info(line)

    def every(self, period_s: float, callback: Callable[[], None]) -> Timer:
        """Call back at a period of wall time, whatever ROS time does."""

        def call() -> None:
            # Raised on, it would come out of the executor, or end other nodes too.
            try:
                with self.turns as mine:
                    if mine:
                        callback()
            except TrawlError as reason:
                self.end(1, str(reason))
            except KeyboardInterrupt:
                # Of a compilation that `run` stops: the executor would print it.
                self.end(0)
            except Exception as reason:
                self._note_trouble(callback.__qualname__, error_of_program(reason))

        return self.create_timer(period_s, call, clock=self.steady_clock)

    @property
    def services(self) -> Iterator[Service]:
        """Services that an executor answers."""
        return (service for service in super().services if service not in self._awaiting)

    def offer_awaiting(self, service: str, answer: Answer) -> None:
        """Offer a Trigger service that a coroutine answers while messages come in.

        An error of the coroutine becomes a refusal with its reason.
        """

        async def refusing(request: Any, response: Any) -> Any:
            try:
                return await answer(request, response)
            except Exception as reason:
                # Unanswered, who asked would wait for good.
                response.success, response.message = False, self.refusal(service, reason)
                return response

        offered = self.create_service(Trigger, service, refusing)
        self._awaiting.append(offered)
        self.every(PERIOD_S, AwaitingService(offered, refusing).go_on)

    def close(self) -> None:
        """Finish work and report the final counts; a second call does nothing."""
        if not self.turns.end():
            return
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

    def _note_trouble(self, activity: str, sentence: str) -> None:
        if self._troubles.get(activity) != sentence:
            self._troubles[activity] = sentence
            self.get_logger().error(f'{activity}: {sentence}')

    def all_statuses(self) -> list[Status]:
        """Give what the node says of itself on /diagnostics, each sentence and value bounded."""
        clock = clock_status(self)
        clock = replace(clock, values={**clock.values, **self.real_time_factor.report()})
        return [_bounded(status) for status in (self._traffic_status(), clock, *self.statuses())]

    def _report(self) -> None:
        """Report each second; for the first time as soon as somebody listens."""
        self.match_publishers()
        if self._greet_until is not None:
            if time.monotonic() < self._greet_until and not self._has_listener():
                return
            self._greet_until = None
            self._reporter.timer_period_ns = round(DIAGNOSTICS_PERIOD_S * SECOND)
        self._diagnose()

    def _has_listener(self) -> bool:
        if not self._senders[DIAGNOSTICS].get_subscription_count():
            return False
        # A clock that is not heard of yet would be reported as missing.
        simulated = self.get_parameter('use_sim_time').value
        return not simulated or bool(self.get_publishers_info_by_topic(CLOCK.name))

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
            self.subscribed,
            {sender.topic_name: sender.qos_profile for sender in self._senders.values()},
        )
        if there := elsewhere(self, self.subscribed):
            problems.append(there)
        if refused := self.traffic.total('refused'):
            last = next(reversed(self._refused.values()))
            problems.append(f'{refused} messages left out, the last because {last}')
        # Older messages of a latched topic are meant to be given up for its newest.
        for full, listener in self._listeners.items():
            if listener.subscription.qos_profile.durability != DurabilityPolicy.TRANSIENT_LOCAL:
                self.traffic.lost(full, self._sources[full].lost)
        if dropped := self.traffic.dropped:
            problems.append(f'{dropped} messages were lost on the way here')
        values = self.traffic.report()
        message = '; '.join(problems) or 'messages are flowing as they should'
        level = WARN if problems else OK
        if self._troubles:
            activity, sentence = list(self._troubles.items())[-1]
            level, message = ERROR, f'{activity}: {sentence}'
        return Status('messages', level, message, values)


def _bounded(status: Status) -> Status:
    """Cut what may repeat something foreign, as the names of consumers."""
    values = {key: one_line(value, DIAGNOSIS.value) for key, value in status.values.items()}
    return replace(status, message=one_line(status.message, DIAGNOSIS.value), values=values)
