# Copyright the trawl_ros developers
# SPDX-License-Identifier: Apache-2.0
"""`bag_player`: publishes a bag again, message for message, and ends with it."""

from collections.abc import Sequence
from time import monotonic
from typing import Any, ClassVar

from rclpy.qos import HistoryPolicy

from trawl_ros.bags.reader import Bag
from trawl_ros.bags.storage.stored import RawMessage
from trawl_ros.core.errors import TrawlError
from trawl_ros.core.stamps import FAR_NS, lasting, when
from trawl_ros.core.time import SECOND
from trawl_ros.messages.diagnostics import OK, WARN, Status
from trawl_ros.messages.truth_to_messages import clock_message
from trawl_ros.nodes.playback.replay import Excerpt, replayed
from trawl_ros.nodes.runtime.credit import STALLED_S, Consumers, Pacer
from trawl_ros.nodes.runtime.node import TrawlNode
from trawl_ros.nodes.runtime.parameters import Flag, Names, Number, Text
from trawl_ros.nodes.runtime.qos import PUBLISHED_DEPTH
from trawl_ros.nodes.runtime.run import run
from trawl_ros.records.topics import CLOCK

BURST_S = 0.05
TICK_S = 0.002
QUIET_S = 3.0
"""Time without progress of consumers after which the end is taken as reached by all."""

CLOCK_STEP = SECOND // 100


class BagPlayer(TrawlNode):
    """Node that plays a bag at a rate, or as fast as its consumers follow.

    Publishers offer the QoS that was recorded. It begins when discovery has finished and all
    of ``wait_for`` report on ``sync/progress``, and ends when subscribers have everything.
    ``~/pause``, ``~/resume``, ``~/toggle_paused`` and ``~/play_next`` (one message, while paused)
    are services.
    """

    SPECS: ClassVar = (
        Text('bag', '', 'Folder of the bag, or one MCAP file.', needed=True),
        Number('rate', 1.0, 'factor', 0.0, 1000.0, 'Recorded seconds per second of wall time; 0 '
               'is as fast as the consumers in wait_for follow.', live=True),
        Names('topics', 'Topics to play, as the bag names them; by default all.'),
        Flag('loop', False, 'Whether to begin again at the end.', live=True),
        Number('start', 0.0, 's', 0.0, 1e7, 'Recorded time to leave out at the beginning.'),
        Number('end', 0.0, 's', 0.0, 1e7, "Recorded time since the bag's first message at which "
               'to end; 0 is at the end of the bag.'),
        Flag('start_paused', False, 'Whether to wait for a call of resume before the first '
             'message.'),
        Flag('publish_clock', False, 'Whether to publish recorded time on /clock; a rate other '
             'than 1 forces it.'),
        Names('wait_for', 'Consumers (node names) without which it does not begin.'),
        Number('lead_s', 3.0, 's', 0.5, 60.0, 'Recorded time that the slowest consumer may lag '
               'behind.', live=True),
    )  # fmt: skip

    _clock_published = False
    _far_off = ''
    _latest = 0

    def __init__(self, **kwargs: Any) -> None:
        super().__init__('bag_player', **kwargs)
        self._check_parameters()
        self._bag = Bag(self.parameters['bag'], namespace=self.get_namespace())
        topics = self._advertise_all()
        self._clock_published = self.parameters['publish_clock'] or self.parameters['rate'] != 1.0
        if self._clock_published:
            self.advertise(CLOCK.name)
        self._consumers = Consumers(self, self.parameters['wait_for'])
        self._pacer = Pacer(self.parameters['rate'])
        self._halves: dict[str, tuple[int, int | None]] = {}
        self._rounds = 0
        self._began = False
        self._ended = False
        self._paused = self.parameters['start_paused']
        self._last_progress: tuple[int | None, float] = (None, monotonic())
        self._excerpt = Excerpt(self._bag, topics, self.parameters['start'], self.parameters['end'])
        self._begin()
        for act in (self._pause, self._resume, self._toggle_paused, self._play_next):
            self.offer(f'~/{act.__name__.strip("_")}', act)
        self.every(TICK_S, self._tick)

    def now(self) -> int:
        """Return the time that this node publishes on /clock, or that of its own clock, ns."""
        return self._latest if self._clock_published else super().now()

    def objection(self, name: str, value: Any) -> str | None:
        """Return an objection to a live parameter's value; None without one."""
        if name != 'rate':
            return None
        if value == 0.0 and not self.parameters['wait_for']:
            return 'rate: found 0 without wait_for, expected a rate above 0'
        if value != 1.0 and not self._clock_published:
            return (
                f'rate: found {value:g}, expected 1, since /clock is not published; set '
                'publish_clock at the start'
            )
        return None

    def parameter_changed(self, name: str) -> None:
        """Apply a live parameter's new value."""
        if name == 'rate':
            self._pacer.change(self.parameters['rate'])

    def statuses(self) -> list[Status]:
        """Return the status of the replay."""
        missing = [] if self._began else self._consumers.missing()
        slow = self._consumers.waited_for() if self._held_up else []
        values = {
            'bag': str(self._bag.path),
            'played until': f'{self._latest / 1e9:.1f}',
            'rounds': str(self._rounds),
            'waits for': ', '.join([*missing, *slow]),
        }
        if missing:
            text = f'waits for {", ".join(missing)}, which should report on sync/progress'
            return [Status('bag', WARN, self.with_namespace(text), values)]
        problems = [*filter(None, [self._far_off]), *self._left_out, *self._bag.problems]
        if stalled := self._consumers.stalled():
            problems.append(
                f'goes on without {", ".join(stalled)}, not getting on for {STALLED_S:g} s'
            )
        if slow:
            problems.append(f'waits for {", ".join(slow)}, which gets on too slowly')
        if problems:
            return [Status('bag', WARN, '; '.join(problems), values)]
        if self._paused:
            return [Status('bag', OK, 'paused', values)]
        return [Status('bag', OK, 'playing' if self._began else 'waits for subscribers', values)]

    def _check_parameters(self) -> None:
        start, end = self.parameters['start'], self.parameters['end']
        if self.parameters['rate'] == 0.0 and not self.parameters['wait_for']:
            raise TrawlError(
                'parameter rate: found 0 without wait_for, expected the names of consumers to '
                'follow, or a rate above 0'
            )
        if 0.0 < end <= start:
            raise TrawlError(f'parameter end: found {end:g}, expected more than start ({start:g})')

    def _advertise_all(self) -> list[str]:
        """Create the publishers, and give the topics as the bag names them."""
        # Remappings say where a topic goes, and not what it is called in the bag.
        wanted = [
            self.resolve_topic_name(name, only_expand=True) for name in self.parameters['topics']
        ]
        topics, self._left_out = replayed(self._bag, wanted, self.get_namespace())
        self._depths: dict[str, int] = {}
        for name, topic in topics.items():
            offer = self.advertise(name, topic.type, topic.profile).qos_profile
            keeps_last = offer.history == HistoryPolicy.KEEP_LAST
            self._depths[name] = offer.depth if keeps_last else PUBLISHED_DEPTH
            if not topic.as_recorded:
                self.get_logger().info(
                    f'{name}: its publishers offered different QoS; the usual one is offered'
                )
        for sentence in self._left_out:
            self.get_logger().warning(sentence)
        return list(topics)

    def _begin(self) -> None:
        self._held_up = False
        first = self._excerpt.begin()
        self._latest = first.log_time
        self._clocked: int | None = None
        self._halves.clear()
        self._pacer.restart()
        self._consumers.begin(first.log_time)

    def _tick(self) -> None:
        self._began = self._began or self._consumers.ready()
        if not self._began or self._paused:
            return
        if self._ended:
            if self.exit_code is None:
                self._end_if_done()
            return
        end = monotonic() + BURST_S
        while (message := self._excerpt.upcoming) and self._may_go_on(message.log_time):
            self._play(message)
            if monotonic() > end:
                return
        self._announce_pause(message)
        if self._excerpt.upcoming is None:
            self._finish_round()

    def _may_go_on(self, stamp: int) -> bool:
        lead = round(self.parameters['lead_s'] * SECOND)
        followed = self._consumers.followed(self._latest - lead)
        self._held_up = not followed and not self._stand_still(self._consumers.slowest())
        if self._held_up:
            self._pacer.restart()
            return False
        return self._pacer.due(stamp / SECOND)

    def _announce_pause(self, upcoming: RawMessage | None) -> None:
        """Report a next message that is far off, as after a stamp that cannot be."""
        rate = self.parameters['rate']
        wait = upcoming.log_time - self._latest if upcoming and rate else 0
        far = wait > rate * FAR_NS
        self._far_off = (
            f'the next message comes in {lasting(round(wait / rate))}, at '
            f'{when(self._latest + wait)}; parameter start leaves out what is before it'
            if far
            else ''
        )
        self.say('next message', WARN if far else OK, self._far_off or 'is near')

    def _stand_still(self, slowest: int | None) -> bool:
        """Return True if all consumers are idle and none has progressed for `QUIET_S`."""
        now = monotonic()
        if self._last_progress[0] != slowest or self._consumers.busy():
            self._last_progress = (slowest, now)
        return now - self._last_progress[1] > QUIET_S

    def _play(self, message: RawMessage) -> None:
        stamp = message.log_time
        if self._clock_published and (self._clocked is None or stamp - self._clocked >= CLOCK_STEP):
            self._clocked = stamp
            self.send(*clock_message(stamp))
        self.send_bytes(message.topic, message.data)
        self._latest = stamp
        self._consumers.sent(stamp)
        self._let_arrive(message.topic)
        self._excerpt.advance()

    def _let_arrive(self, topic: str) -> None:
        # Counted in halves of what the publisher keeps: a half goes out when the one before has
        # arrived, so that nothing that may have to be sent again is ever replaced.
        sent, before = self._halves.get(topic, (0, None))
        if sent + 1 < self._depths[topic] // 2:
            self._halves[topic] = (sent + 1, before)
            return
        slowest = self._consumers.slowest()
        # Progress proves arrival at once; an acknowledgement may take half a second to come.
        if before is not None and (slowest is None or slowest < before):
            self.all_acknowledged(1.0)
        self._halves[topic] = (0, self._latest)

    def _finish_round(self) -> None:
        self._rounds += 1
        self.all_acknowledged(1.0)
        if self.parameters['loop']:
            self._begin()
            return
        self._ended = True

    def _end_if_done(self) -> None:
        slowest = self._consumers.slowest()
        reached = self._consumers.followed(self._latest) or self._stand_still(slowest)
        if reached and self.all_acknowledged(1.0):
            for problem in self._bag.problems:
                self.get_logger().warning(problem)
            self.end(0, f'{self._bag.path}: played {self._rounds} times to its end')

    def _pause(self) -> str:
        self._paused = True
        return f'paused at {self._latest / SECOND:.3f}'

    def _resume(self) -> str:
        self._paused = False
        self._pacer.restart()
        return f'goes on from {self._latest / SECOND:.3f}'

    def _toggle_paused(self) -> str:
        return self._resume() if self._paused else self._pause()

    def _play_next(self) -> str:
        if not self._paused:
            raise TrawlError('playing; expected a call of pause before')
        message = self._excerpt.upcoming
        if message is None:
            raise TrawlError('at the end; expected a call of resume')
        self._play(message)
        return f'played {message.topic} of {message.log_time / SECOND:.3f}'


def main(args: Sequence[str] | None = None) -> int:
    """Run the node."""
    return run(BagPlayer, args)
